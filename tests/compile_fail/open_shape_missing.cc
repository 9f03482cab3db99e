// SPDX-License-Identifier: Apache-2.0
// refused: this type leaves the shape open: give it after the unit, as "[ndof<=10]"
#include "chimera/task/component.h"

using namespace chimera;

struct Bad {
  In<double[]> x{"x", "m"};
  void cycle() {}
};
CHIMERA_COMPONENT(Bad, "bad", "Does not compile.");
