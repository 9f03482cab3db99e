// SPDX-License-Identifier: Apache-2.0
// Removes small deviations, without a jump at the edges. README.md is the data sheet.
#include "chimera/task/component.h"
#include "library/signals/input.h"

using namespace chimera;

struct Deadband {
  In<double[]>      x{"x", "U", "[n...<=64]", doc = "Any signal."};
  InConst<double[]> width{"width", "U", "[n...<=64]", range(0, library::kNoLimit), doc = "Half width of the band."};
  InConst<double[]> center{"center", "U", "[n...<=64]", initial = 0.0, doc = "Middle of the band."};
  Out<double[]>     y{"y", "U", "[n...<=64]", doc = "x behind the deadband."};

  Outcome init() {
    for (std::size_t i = 0; i < width.size(); ++i)
      if (!(width[i] >= 0) || !math::is_finite(width[i]) || !math::is_finite(center[i]))
        return fault("width must be 0 or more, and center finite");
    return ok();
  }
  Outcome reinit() { return init(); }
  void on() {
    if (library::all_finite(x)) take_out();
  }
  Outcome cycle() {
    const Outcome input = library::judge(x, "x");
    if (library::is_ok(input)) take_out();
    return input;
  }
  bool error() { return true; }

 private:
  void take_out() {
    const double *in = x.begin(), *half = width.begin(), *middle = center.begin();
    for (double& out : y) {
      const double away = *in++ - *middle, seen = math::fabs(away) - *half++;
      out = *middle++ + (seen > 0 ? math::copysign(seen, away) : 0);
    }
  }
};
CHIMERA_COMPONENT(Deadband, "deadband", "Removes small deviations, without a jump at the edges.");
