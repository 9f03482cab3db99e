// SPDX-License-Identifier: Apache-2.0
// Limits the rate of a signal. README.md is the data sheet.
#include <algorithm>

#include "chimera/task/component.h"
#include "library/signals/input.h"

using namespace chimera;

struct RateLimit {
  In<double[]>      x{"x", "U", "[n...<=64]", doc = "Any signal."};
  InConst<double[]> rise{"rise", "U/s", "[n...<=64]", range(0, library::kNoLimit),
                         doc = "How fast y may grow; above 0."};
  InConst<double[]> fall{"fall", "U/s", "[n...<=64]", range(0, library::kNoLimit),
                         doc = "How fast y may fall; above 0."};
  Out<double[]>     y{"y", "U", "[n...<=64]", doc = "x, limited in rate."};

  Outcome init() {
    for (std::size_t i = 0; i < rise.size(); ++i)
      if (!(rise[i] > 0 && fall[i] > 0)) return fault("rise and fall must be above 0");
    return ok();
  }
  Outcome reinit() { return init(); }
  // Continues from the last output, of an earlier run or a predecessor, without a jump.
  void on() {
    if (!library::all_finite(y) && library::all_finite(x)) std::copy(x.begin(), x.end(), y.begin());
  }
  Outcome cycle(Cycle c) {
    const Outcome input = library::judge(x, "x");
    if (!library::is_ok(input)) return input;
    if (!library::all_finite(y)) {  // the first value
      on();
      return ok();
    }
    const double dt = c.dt();
    const double *in = x.begin(), *up = rise.begin(), *down = fall.begin();
    for (double& out : y) out = std::clamp(*in++, out - *down++ * dt, out + *up++ * dt);
    return ok();
  }
  bool error() { return true; }
};
CHIMERA_COMPONENT(RateLimit, "rate_limit", "Follows a signal no faster than allowed.");
