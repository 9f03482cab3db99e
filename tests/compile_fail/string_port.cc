// SPDX-License-Identifier: Apache-2.0
#include <string>

#include "chimera/task/component.h"

using namespace chimera;

struct Bad {
  In<std::string> x{"x"};
  void cycle() {}
};
CHIMERA_COMPONENT(Bad, "bad", "Does not compile.");
