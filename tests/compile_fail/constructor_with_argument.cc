// SPDX-License-Identifier: Apache-2.0
// refused: a component is made without arguments: what it needs comes by in-const and resource ports
#include "chimera/task/component.h"

using namespace chimera;

struct Bad {
  explicit Bad(int) {}
  void cycle() {}
};
CHIMERA_COMPONENT(Bad, "bad", "Does not compile.");
