// SPDX-License-Identifier: Apache-2.0
#include "chimera/task/component.h"

using namespace chimera;

struct Bad {
  In<Text<8>> x{"x", configuration};
  void cycle() {}
};
CHIMERA_COMPONENT(Bad, "bad", "Does not compile.");
