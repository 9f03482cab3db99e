// SPDX-License-Identifier: Apache-2.0
// refused: 'error' is a method of every component: write it as error(Cycle) or error(), public, or give this member another name
#include "chimera/task/component.h"

using namespace chimera;

struct Bad {
  double error = 0;
  void cycle() {}
};
CHIMERA_COMPONENT(Bad, "bad", "Does not compile.");
