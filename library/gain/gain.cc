// SPDX-License-Identifier: Apache-2.0
// Multiplies one signal by a constant: y = k x. README.md is the data sheet.
#include "chimera/task/component.h"

using namespace chimera;

struct Gain {
  In<double>      x{"x", "U", doc = "Any signal."};
  InConst<double> k{"k", "X/U", initial = 1.0, doc = "Factor."};
  Out<double>     y{"y", "X", doc = "Product."};
  void on()    { *y = *k * *x; }
  void cycle() { *y = *k * *x; }
};
CHIMERA_COMPONENT(Gain, "gain", "Multiplies one signal by a constant.");
