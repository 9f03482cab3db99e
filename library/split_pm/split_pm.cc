// SPDX-License-Identifier: Apache-2.0
// Splits a force into engine force and brake force (2000 paper, figure 17).
#include <algorithm>
#include <cmath>

#include "chimera/task/component.h"
#include "library/signals/input.h"

using namespace chimera;

namespace {

struct SplitPm {
  In<double> fd{"fd", "N", doc = "Wanted force; below 0 brakes."};
  Out<double> fde{"fde", "N", doc = "Wanted engine force."};
  Out<double> fdw{"fdw", "N", doc = "Wanted brake force."};

  Outcome on() { return library::required(cycle(), "fd is not finite"); }
  Outcome cycle() {
    if (!std::isfinite(*fd)) return library::unfit("fd is not finite", fd);
    *fde = std::max(0.0, *fd);
    *fdw = std::max(0.0, -*fd);
    return ok();
  }
  bool error() { return true; }
};

CHIMERA_COMPONENT(SplitPm, "split_pm", "Splits a force into engine and brake force.", rate = 50.0,
                  source = "2000 paper, section 6, figure 17");

}  // namespace
