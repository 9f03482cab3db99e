// SPDX-License-Identifier: Apache-2.0
// @NAME@: smooths one signal with a time constant. Change it into what you need.
#include <cmath>

#include "chimera/task/component.h"

using namespace chimera;

struct @TYPE@Component {
  In<double>      x{"x", "U", doc = "any signal"};
  InConst<double> time{"time", "s", initial = 0.1, range(1e-6, 1e6), doc = "time constant"};
  Out<double>     y{"y", "U", doc = "the signal, smoothed"};

  void on() { *y = *x; }  // no step when the task goes ON
  Outcome cycle(Cycle c) {
    if (!std::isfinite(*x)) return fault("x is not finite");  // else it would stay in y for ever
    *y += (*x - *y) * c.dt() / (*time + c.dt());
    return ok();
  }
};
CHIMERA_COMPONENT(@TYPE@Component, "@NAME@", "Smooths one signal.", rate = 100.0);
