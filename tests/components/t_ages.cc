// SPDX-License-Identifier: Apache-2.0
// Publishes age, freshness and validity of its in-var.
#include "chimera/task/component.h"

using namespace chimera;

struct Ages {
  In<double> x{"x", "U"};
  Out<double> y{"y", "U", doc = "x, when it is valid; never written before that"};
  Out<double> age{"age", "s", initial = -1.0, doc = "-1 while x is not valid"};
  Out<bool> fresh{"fresh", initial = false};
  Out<bool> valid{"valid", initial = false};

  void cycle() {
    if (x.valid()) *y = *x;
    *age = x.valid() ? to_seconds(x.age()) : -1.0;
    *fresh = x.fresh();
    *valid = x.valid();
  }
};
CHIMERA_COMPONENT(Ages, "t_ages", "Shows age, freshness and validity of its input.", rate = 1000.0);
