// SPDX-License-Identifier: Apache-2.0
#include "chimera/task/component.h"

using namespace chimera;

struct Bad {
  void cycle() {}
  void background(Cycle) {}
};
CHIMERA_COMPONENT(Bad, "bad", "Does not compile.");
