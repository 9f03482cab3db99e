// SPDX-License-Identifier: Apache-2.0
// refused: a port cannot carry a pointer: it means nothing in another process
#include "chimera/task/component.h"

using namespace chimera;

struct Bad {
  In<double*> x{"x", "m"};
  void cycle() {}
};
CHIMERA_COMPONENT(Bad, "bad", "Does not compile.");
