// SPDX-License-Identifier: Apache-2.0
// refused: initial goes with an out-var (its value at spawn) or an in-const (its default): an in-var gets its first value from its producer
#include "chimera/task/component.h"

using namespace chimera;

struct Bad {
  In<double> x{"x", "m", initial = 0.0};
  void cycle() {}
};
CHIMERA_COMPONENT(Bad, "bad", "Does not compile.");
