// SPDX-License-Identifier: Apache-2.0
#include "chimera/task/component.h"

using namespace chimera;

struct Bad {
  InConst<double> x{"x", "m", configuration};
  void cycle() {}
};
CHIMERA_COMPONENT(Bad, "bad", "Does not compile.");
