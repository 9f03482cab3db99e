// SPDX-License-Identifier: Apache-2.0
// The modified split of the 2000 paper (figure 18): a pedal overrides the control.
#include <algorithm>
#include <cmath>

#include "chimera/task/component.h"
#include "library/signals/input.h"

using namespace chimera;

namespace {

struct SplitPmOverride {
  In<double> fd{"fd", "N", doc = "Wanted force; below 0 brakes."};
  In<double> fra{"fra", "N", doc = "Force of the accelerator pedal; 0: not pressed."};
  In<double> frb{"frb", "N", doc = "Force of the brake pedal; 0: not pressed."};
  Out<double> fde{"fde", "N", doc = "Wanted engine force."};
  Out<double> fdw{"fdw", "N", doc = "Wanted brake force."};

  Outcome on() { return library::required(cycle(), "fd, fra or frb is not finite"); }
  Outcome cycle() {
    if (!std::isfinite(*fd) || !std::isfinite(*fra) || !std::isfinite(*frb))
      return library::unfit("fd, fra or frb is not finite", fd, fra, frb);
    if (*fra != 0 || *frb != 0) {
      *fde = *fra;
      *fdw = *frb;
      return ok();
    }
    *fde = std::max(0.0, *fd);
    *fdw = std::max(0.0, -*fd);
    return ok();
  }
  bool error() { return true; }
};

CHIMERA_COMPONENT(SplitPmOverride, "split_pm_override",
                  "Splits a force into engine and brake force, unless a pedal is pressed.", rate = 50.0,
                  source = "2000 paper, section 6, figure 18");

}  // namespace
