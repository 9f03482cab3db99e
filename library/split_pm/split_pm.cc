// SPDX-License-Identifier: Apache-2.0
// Splits one force into one for the engine and one for the brakes (2000 paper, figure 17).
#include "chimera/task/component.h"

using namespace chimera;

namespace {

struct SplitPm {
  In<double> fd{"fd", "N", doc = "Force wanted by the control; below 0 to brake."};
  Out<double> fde{"fde", "N", doc = "Force wanted of the engine, 0 or more."};
  Out<double> fdw{"fdw", "N", doc = "Force wanted of the brakes, 0 or more."};

  void on() { cycle(); }
  void cycle() {
    *fde = *fd > 0 ? *fd : 0;
    *fdw = *fd > 0 ? 0 : -*fd;
  }
};

CHIMERA_COMPONENT(SplitPm, "split_pm", "Splits a force into engine and brake force.", rate = 50.0,
                  source = "2000 paper, section 6, figure 17");

}  // namespace
