// SPDX-License-Identifier: Apache-2.0
// refused: a port cannot carry this type: it keeps its value elsewhere or needs a constructor to be copied; use Text<N> for text, T[N] for a list, or a plain struct
#include <vector>

#include "chimera/task/component.h"

using namespace chimera;

struct Bad {
  Out<std::vector<double>> x{"x", "m"};
  void cycle() {}
};
CHIMERA_COMPONENT(Bad, "bad", "Does not compile.");
