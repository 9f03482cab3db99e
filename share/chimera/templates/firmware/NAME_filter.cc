// SPDX-License-Identifier: Apache-2.0
// @NAME@_filter: smooths one signal with a time constant. Change it into what you need.
#include "chimera/base/math.h"
#include "chimera/task/component.h"

using namespace chimera;

struct @TYPE@Filter {
  In<double>      x{"x", "U", doc = "any signal"};
  InConst<double> time{"time", "s", initial = 0.1, range(1e-6, 1e6), doc = "time constant"};
  Out<double>     y{"y", "U", doc = "the signal, smoothed"};

  void on() { *y = *x; }  // no step when the task goes ON
  Outcome cycle(Cycle c) {
    if (!math::is_finite(*x)) return fault("x is not finite");  // else it would stay in y for ever
    *y += (*x - *y) * c.dt() / (*time + c.dt());
    return ok();
  }
};
CHIMERA_COMPONENT(@TYPE@Filter, "@NAME@_filter", "Smooths one signal.", rate = 100.0);
