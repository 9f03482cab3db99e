// SPDX-License-Identifier: Apache-2.0
// Time derivative of one signal by backward difference: dx = (x - x_last) / dt.
// README.md is the data sheet.
#include "chimera/task/component.h"

using namespace chimera;

struct TimeDerivative {
  In<double>  x {"x",  "U", doc = "Any signal."};  // any unit U
  Out<double> dx{"dx", "U/s", initial = 0.0, doc = "Its derivative."};
  void on(Cycle)      { last_ = *x; *dx = 0; }
  void cycle(Cycle c) { *dx = (*x - last_) / c.dt(); last_ = *x; }
  double last_ = 0;
};
CHIMERA_COMPONENT(TimeDerivative, "tderiv", "Time derivative of one signal.");
