// SPDX-License-Identifier: Apache-2.0
// The modified split of the 2000 paper (figure 18): a pedal overrides the control.
#include "chimera/task/component.h"

using namespace chimera;

namespace {

struct SplitPmOverride {
  In<double> fd{"fd", "N", doc = "Force wanted by the control; below 0 to brake."};
  In<double> fra{"fra", "N", doc = "Force asked for by the accelerator pedal; 0: foot off."};
  In<double> frb{"frb", "N", doc = "Force asked for by the brake pedal; 0: foot off."};
  Out<double> fde{"fde", "N", doc = "Force wanted of the engine, 0 or more."};
  Out<double> fdw{"fdw", "N", doc = "Force wanted of the brakes, 0 or more."};

  void on() { cycle(); }
  void cycle() {
    if (*fra != 0 || *frb != 0) {
      *fde = *fra;
      *fdw = *frb;
      return;
    }
    *fde = *fd > 0 ? *fd : 0;
    *fdw = *fd > 0 ? 0 : -*fd;
  }
};

CHIMERA_COMPONENT(SplitPmOverride, "split_pm_override", "Splits a force into engine and brake force, unless a pedal is pressed.", rate = 50.0,
                  source = "2000 paper, section 6, figure 18");

}  // namespace
