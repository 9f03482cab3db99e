// SPDX-License-Identifier: Apache-2.0
#include "chimera/task/component.h"

using namespace chimera;

struct Bad {
  InConst<double> R{"R", "ohm"};
  void cycle() {}
};
CHIMERA_COMPONENT(Bad, "bad", "Does not compile.");
