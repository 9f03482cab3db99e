// SPDX-License-Identifier: Apache-2.0
// Two unit variables and an expression of both.
#include "chimera/task/component.h"

using namespace chimera;

struct Units {
  In<double> a{"a", "U"};
  In<double> b{"b", "X"};
  Out<double> product{"product", "U.X"};
  Out<double> ratio{"ratio", "U/X"};
  void cycle() {
    *product = *a * *b;
    *ratio = *a / *b;
  }
};
CHIMERA_COMPONENT(Units, "t_units", "Product and ratio of two signals.", rate = 1000.0);
