// SPDX-License-Identifier: Apache-2.0
// refused: a port cannot carry an enum: use std::int32_t and say the values in doc
#include "chimera/task/component.h"

using namespace chimera;

enum Colour { kRed };
struct Bad {
  In<Colour> x{"x"};
  void cycle() {}
};
CHIMERA_COMPONENT(Bad, "bad", "Does not compile.");
