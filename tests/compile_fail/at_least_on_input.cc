// SPDX-License-Identifier: Apache-2.0
#include "chimera/task/component.h"

using namespace chimera;

struct Bad {
  In<double> x{"x", "m", at_least = "low"};
  void cycle() {}
};
CHIMERA_COMPONENT(Bad, "bad", "Does not compile.");
