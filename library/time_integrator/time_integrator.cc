// SPDX-License-Identifier: Apache-2.0
// Integrates each element of a signal over time (1994 paper, figure 9: joint speeds to joint positions).
#include <algorithm>
#include <utility>

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
    stood_ = false;
    if (integral.is_handed_over() && library::all_finite(integral)) return ok();
    if (!library::all_finite(start)) return fault("start is not finite");
    std::ranges::copy(start, integral.begin());
    return ok();
  }
  // While the configuration is illegal, the machine holds itself, so the integral waits; then it begins at `start`.
  Outcome cycle(Cycle c) {
    stood_ = stood_ || c.illegal();
    if (c.illegal()) return ok();
    Outcome inputs = library::judge(rate_of_change, "rate_of_change");
    if (library::is_ok(inputs) && stood_) inputs = library::judge(start, "start");
    if (!library::is_ok(inputs)) return inputs;
    if (std::exchange(stood_, false)) std::ranges::copy(start, integral.begin());
    for (std::size_t i = 0; i < integral.size(); ++i) integral[i] += rate_of_change[i] * c.dt();
    return ok();
  }
  bool error() { return true; }

 private:
  bool stood_ = false;  // the flag was up in the last cycle
};

CHIMERA_COMPONENT(TimeIntegrator, "time_integrator", "The integral of a signal over time, each element by itself.",
                  rate = 1000.0, source = "1994 paper, figure 9");

}  // namespace
