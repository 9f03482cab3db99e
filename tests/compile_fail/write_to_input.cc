// SPDX-License-Identifier: Apache-2.0
#include "chimera/task/component.h"

using namespace chimera;

struct Bad {
  In<double> x{"x", "m"};
  void cycle() { *x = 1; }
};
CHIMERA_COMPONENT(Bad, "bad", "Does not compile.");
