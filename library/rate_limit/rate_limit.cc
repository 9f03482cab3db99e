// SPDX-License-Identifier: Apache-2.0
// Limits the rate of a signal. README.md is the data sheet.
#include <algorithm>
#include <utility>

#include "chimera/task/component.h"
#include "library/signals/input.h"

using namespace chimera;

struct RateLimit {
  In<double[]>      x{"x", "U", "[n...<=64]", doc = "Any signal."};
  Many<In<double[]>, 1> start{"start*", "U", "[n...<=64]", doc = "Measured value of y, for on; may be left out."};
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
  // Continues from an output that is handed over, else begins at `start`, else at the last output.
  void on() {
    stood_ = false;
    begin(y.is_handed_over());
  }
  Outcome cycle(Cycle c) {
    const Outcome input = library::judge(x, "x");
    if (!library::is_ok(input)) return input;
    stood_ = stood_ || c.illegal();
    if (c.illegal() && start.size() > 0) return ok();  // the machine holds itself
    if (std::exchange(stood_, false) || !library::all_finite(y)) {
      begin(false);
      return ok();
    }
    const double dt = c.dt();
    const double *in = x.begin(), *up = rise.begin(), *down = fall.begin();
    for (double& out : y) out = std::clamp(*in++, out - *down++ * dt, out + *up++ * dt);
    return ok();
  }
  bool error() { return true; }

 private:
  void begin(bool goes_on) {
    if (goes_on && library::all_finite(y)) return;
    if (start.size() > 0 && library::all_finite(start[0])) std::ranges::copy(start[0], y.begin());
    else if (!library::all_finite(y) && library::all_finite(x)) std::ranges::copy(x, y.begin());
  }

  bool stood_ = false;  // the flag was up in the last cycle
};
CHIMERA_COMPONENT(RateLimit, "rate_limit", "Follows a signal no faster than allowed.");
