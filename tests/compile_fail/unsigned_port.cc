// SPDX-License-Identifier: Apache-2.0
// refused: a port carries bool, int32, int64, float or double: no other number type is known everywhere
#include "chimera/task/component.h"

using namespace chimera;

struct Bad {
  In<unsigned> x{"x", "1"};
  void cycle() {}
};
CHIMERA_COMPONENT(Bad, "bad", "Does not compile.");
