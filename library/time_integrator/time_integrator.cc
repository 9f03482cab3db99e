// SPDX-License-Identifier: Apache-2.0
// Integrates each element of a signal over time (1994 paper, figure 9: joint speeds to joint positions).
#include <algorithm>
#include <cmath>

#include "chimera/task/component.h"
#include "library/signals/input.h"

using namespace chimera;

namespace {

struct TimeIntegrator {
  In<double[]> rate_of_change{"rate_of_change", "U/s", "[n...<=64]", doc = "Any rate."};
  In<double[]> start{"start", "U", "[n...<=64]", doc = "Integral at on, unless it is handed over."};
  Out<double[]> integral{"integral", "U", "[n...<=64]", initial = 0.0, doc = "The integral."};

  // Bumpless: continues from an integral that is handed over.
  Outcome on() {
    if (integral.is_handed_over() && library::all_finite(integral)) return ok();
    for (std::size_t i = 0; i < integral.size(); ++i) {
      if (!std::isfinite(start[i])) return fault("start is not finite");
    }
    std::ranges::copy(start, integral.begin());
    return ok();
  }
  Outcome cycle(Cycle c) {
    if (c.illegal()) return ok();
    for (std::size_t i = 0; i < integral.size(); ++i) {
      if (!std::isfinite(rate_of_change[i])) return fault("what is integrated is not finite");
    }
    for (std::size_t i = 0; i < integral.size(); ++i) integral[i] += rate_of_change[i] * c.dt();
    return ok();
  }
};

CHIMERA_COMPONENT(TimeIntegrator, "time_integrator", "The integral of a signal over time, each element by itself.",
                  rate = 1000.0, source = "1994 paper, figure 9");

}  // namespace
