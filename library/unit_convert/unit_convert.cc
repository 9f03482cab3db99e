// SPDX-License-Identifier: Apache-2.0
// Converts a signal to another unit: y = factor x + offset. README.md is the data sheet.
#include "chimera/task/component.h"
#include "library/signals/input.h"

using namespace chimera;

struct UnitConvert {
  In<double[]>    x{"x", "U", "[n...<=64]", doc = "A signal in one unit."};
  InConst<double> factor{"factor", "X/U", doc = "What one U is in X; not 0."};
  InConst<double> offset{"offset", "X", initial = 0.0, doc = "What 0 U is in X, as 273.15 K for 0 degC."};
  Out<double[]>   y{"y", "X", "[n...<=64]", doc = "The same signal in the other unit."};

  Outcome init() {
    if (!math::is_finite(*factor) || *factor == 0) return fault("factor must be finite and not 0");
    if (!math::is_finite(*offset)) return fault("offset must be finite");
    return ok();
  }
  Outcome reinit() { return init(); }
  void on() {
    if (library::all_finite(x)) convert();
  }
  Outcome cycle() {
    const Outcome input = library::judge(x, "x");
    if (library::is_ok(input)) convert();
    return input;
  }
  bool error() { return true; }

 private:
  void convert() {
    const double *in = x.begin(), times = *factor, plus = *offset;
    for (double& out : y) out = times * *in++ + plus;
  }
};
CHIMERA_COMPONENT(UnitConvert, "unit_convert", "Converts a signal to another unit.");
