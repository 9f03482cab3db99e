// SPDX-License-Identifier: Apache-2.0
// @NAME@: smooths one signal with a time constant. Change it into what you need.
#include "chimera/task/component.h"

using namespace chimera;

struct @TYPE@Component {
  In<double>      x{"x", "U", doc = "any signal"};
  InConst<double> time{"time", "s", initial = 0.1, range(1e-6, 1e6), doc = "time constant"};
  Out<double>     y{"y", "U", doc = "the signal, smoothed"};

  void on() { *y = *x; }  // no step when the task goes ON
  void cycle(Cycle c) { *y += (*x - *y) * c.dt() / (*time + c.dt()); }
};
CHIMERA_COMPONENT(@TYPE@Component, "@NAME@", "Smooths one signal.", rate = 100.0);
