// SPDX-License-Identifier: Apache-2.0
// refused: 'kill' is a method of every component: write it as kill(Cycle) or kill(), public, or give this member another name
#include "chimera/task/component.h"

using namespace chimera;

class Bad {
  void kill() {}

 public:
  void cycle() {}
};
CHIMERA_COMPONENT(Bad, "bad", "Does not compile.");
