// SPDX-License-Identifier: Apache-2.0
// Computes the throttle for a wanted force of the cruise control (2000 paper, figure 15).
#include <algorithm>
#include <cmath>

#include "chimera/task/component.h"
#include "library/signals/input.h"

using namespace chimera;

namespace {

struct Engine {
  In<double> fde{"fde", "N", doc = "Wanted engine force."};
  Out<double> gas{"gas", "1", initial = 0.0, safety, range(0, 1), doc = "Throttle, 0 closed to 1 open."};
  InConst<double> full_gas{"full_gas", "N", initial = 2280.0, range(1, 1e5), doc = "Engine force at full gas."};

  Outcome init() { return *full_gas >= 1 && *full_gas <= 1e5 ? ok() : fault("full_gas is 1 to 100000 N"); }
  Outcome reinit() { return init(); }
  void on() {
    if (gas.is_outdated()) *gas = 0;
  }
  Outcome cycle(Cycle c) {
    if (!c.illegal() && !std::isfinite(*fde)) return library::unfit("fde is not finite", fde);
    *gas = c.illegal() ? 0 : std::clamp(*fde / *full_gas, 0.0, 1.0);
    return ok();
  }
  void off() { *gas = 0; }
};

CHIMERA_COMPONENT(Engine, "engine", "Gives gas for a wanted force.", rate = 50.0, source = "2000 paper, section 6");

}  // namespace
