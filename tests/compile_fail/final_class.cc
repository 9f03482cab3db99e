// SPDX-License-Identifier: Apache-2.0
// refused: a component must not be final: its methods could not be checked
#include "chimera/task/component.h"

using namespace chimera;

struct Bad final {
  void cycle() {}
};
CHIMERA_COMPONENT(Bad, "bad", "Does not compile.");
