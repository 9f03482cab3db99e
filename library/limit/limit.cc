// SPDX-License-Identifier: Apache-2.0
// Cuts a signal at its limits: y = min(max(x, low), high). README.md is the data sheet.
#include <algorithm>

#include "chimera/task/component.h"
#include "library/signals/input.h"

using namespace chimera;

struct Limit {
  In<double[]>      x{"x", "U", "[n...<=64]", doc = "Any signal."};
  InConst<double[]> low{"low", "U", "[n...<=64]", range(-library::kNoLimit, library::kNoLimit),
                        doc = "Least value of y."};
  InConst<double[]> high{"high", "U", "[n...<=64]", range(-library::kNoLimit, library::kNoLimit), at_least = "low",
                         doc = "Greatest value of y."};
  Out<double[]>     y{"y", "U", "[n...<=64]", doc = "x, cut at both limits."};

  Outcome init() {
    for (std::size_t i = 0; i < low.size(); ++i)
      if (!(low[i] <= high[i])) return fault("low must be at most high");
    return ok();
  }
  Outcome reinit() { return init(); }
  void on() {
    if (library::all_finite(x)) cut();
  }
  Outcome cycle() {
    const Outcome input = library::judge(x, "x");
    if (library::is_ok(input)) cut();
    return input;
  }
  bool error() { return true; }

 private:
  void cut() {
    const double *in = x.begin(), *least = low.begin(), *most = high.begin();
    for (double& out : y) out = std::clamp(*in++, *least++, *most++);
  }
};
CHIMERA_COMPONENT(Limit, "limit", "Cuts a signal at its limits.");
