// SPDX-License-Identifier: Apache-2.0
// Reads values as large as t_large has them.
#include "chimera/task/component.h"

using namespace chimera;

struct ReadsLarge {
  In<double[65536]> a{"a", "m"};
  In<double[65536]> b{"b", "m"};
  In<bool[65536]> g{"g"};
  Out<double> sum{"sum", "m", initial = 0.0, doc = "of the first elements of a and b, when that of g is true"};

  void cycle() { *sum = g[0] ? a[0] + b[0] : 0; }
};
CHIMERA_COMPONENT(ReadsLarge, "t_reads_large", "Reads large values.", rate = 1.0);
