// SPDX-License-Identifier: Apache-2.0
#include "chimera/task/component.h"

using namespace chimera;

struct Bad {
  void on(double) {}
  void cycle() {}
};
CHIMERA_COMPONENT(Bad, "bad", "Does not compile.");
