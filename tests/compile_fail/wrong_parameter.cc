// SPDX-License-Identifier: Apache-2.0
// refused: 'on' is a method of every component: write it as on(Cycle) or on(), public, or give this member another name
#include "chimera/task/component.h"

using namespace chimera;

struct Bad {
  void on(double) {}
  void cycle() {}
};
CHIMERA_COMPONENT(Bad, "bad", "Does not compile.");
