// SPDX-License-Identifier: Apache-2.0
// refused: a name has small letters, digits and '_' only
#include "chimera/task/component.h"

using namespace chimera;

struct Bad {
  In<double> x{"qDot", "m"};
  void cycle() {}
};
CHIMERA_COMPONENT(Bad, "bad", "Does not compile.");
