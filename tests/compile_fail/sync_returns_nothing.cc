// SPDX-License-Identifier: Apache-2.0
// refused: 'sync' must return bool (true: an event was taken), or an Outcome
#include "chimera/task/component.h"

using namespace chimera;

struct Bad {
  void sync() {}
  void cycle() {}
};
CHIMERA_COMPONENT(Bad, "bad", "Does not compile.");
