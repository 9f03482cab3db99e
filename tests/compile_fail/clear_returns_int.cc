// SPDX-License-Identifier: Apache-2.0
// refused: 'clear' must return bool (true: the cause is gone), or an Outcome
#include "chimera/task/component.h"

using namespace chimera;

struct Bad {
  void cycle() {}
  int clear() { return 1; }
};
CHIMERA_COMPONENT(Bad, "bad", "Does not compile.");
