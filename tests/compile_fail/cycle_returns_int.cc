// SPDX-License-Identifier: Apache-2.0
#include "chimera/task/component.h"

using namespace chimera;

struct Bad {
  int cycle(Cycle) { return 0; }
};
CHIMERA_COMPONENT(Bad, "bad", "Does not compile.");
