// SPDX-License-Identifier: Apache-2.0
#include "chimera/task/component.h"

using namespace chimera;

struct Bad {
  void cycle() {}
  int event_source() const { return 0; }
};
CHIMERA_COMPONENT(Bad, "bad", "Does not compile.");
