// SPDX-License-Identifier: Apache-2.0
#include <vector>

#include "chimera/task/component.h"

using namespace chimera;

struct Bad {
  Out<std::vector<double>> x{"x", "m"};
  void cycle() {}
};
CHIMERA_COMPONENT(Bad, "bad", "Does not compile.");
