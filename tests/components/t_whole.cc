// SPDX-License-Identifier: Apache-2.0
// Publishes 256 numbers that must be equal, and their sum. It writes slowly, so that most kills of its process come
// between the first and the last number. t_judge checks them.
#include "chimera/task/component.h"

using namespace chimera;

struct Whole {
  InConst<std::int64_t> spend{"spend", "ns", initial = 0, doc = "time between the first half and the second"};
  Out<std::int64_t[256]> number{"number", "ns", doc = "all the same: the instant of the cycle"};
  Out<std::int64_t> sum{"sum", "ns", doc = "of number"};

  void on(Cycle c) { write(c); }
  void cycle(Cycle c) { write(c); }

 private:
  void write(Cycle c) {
    const std::int64_t now = c.now().count;
    *sum = 0;
    for (int i = 0; i < 256; ++i) {
      if (i == 128 && *spend > 0) c.spend({*spend});
      number[i] = now;
      *sum += now;
    }
  }
};
CHIMERA_COMPONENT(Whole, "t_whole", "Publishes numbers that belong together.", rate = 1000.0);
