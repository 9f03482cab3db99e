// SPDX-License-Identifier: Apache-2.0
// Computes the brake force for a wanted force of the cruise control (2000 paper, figure 15).
#include <algorithm>
#include <cmath>

#include "chimera/task/component.h"
#include "library/signals/input.h"

using namespace chimera;

namespace {

struct Wheels {
  In<double> fdw{"fdw", "N", doc = "Wanted brake force."};
  Out<double> fb{"fb", "N", initial = 0.0, safety, range(0, 20000), doc = "Brake force at the wheels."};
  InConst<double> brake_limit{"brake_limit", "N", initial = 12000.0, range(0, 20000), doc = "Largest brake force."};

  Outcome init() {
    return *brake_limit >= 0 && *brake_limit <= 20000 ? ok() : fault("brake_limit is 0 to 20000 N");
  }
  Outcome reinit() { return init(); }
  void on() {
    if (fb.is_outdated()) *fb = 0;
  }
  Outcome cycle(Cycle c) {
    if (!c.illegal() && !std::isfinite(*fdw)) return library::unfit("fdw is not finite", fdw);
    *fb = c.illegal() ? 0 : std::clamp(*fdw, 0.0, *brake_limit);
    return ok();
  }
  void off() { *fb = 0; }
};

CHIMERA_COMPONENT(Wheels, "wheels", "Presses the brakes for a wanted force.", rate = 50.0,
                  source = "2000 paper, section 6");

}  // namespace
