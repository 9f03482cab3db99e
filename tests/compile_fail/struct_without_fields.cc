// SPDX-License-Identifier: Apache-2.0
// refused: a struct needs names and units for its members to go through a port: specialise chimera::Fields for it
#include "chimera/task/component.h"

using namespace chimera;

struct Plain {
  double x;
};
struct Bad {
  In<Plain> x{"x"};
  void cycle() {}
};
CHIMERA_COMPONENT(Bad, "bad", "Does not compile.");
