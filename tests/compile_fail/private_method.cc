// SPDX-License-Identifier: Apache-2.0
#include "chimera/task/component.h"

using namespace chimera;

class Bad {
  void kill() {}

 public:
  void cycle() {}
};
CHIMERA_COMPONENT(Bad, "bad", "Does not compile.");
