// SPDX-License-Identifier: Apache-2.0
// A safety port, and a bad value on demand.
#include <limits>

#include "chimera/task/component.h"

using namespace chimera;

struct Safety {
  InConst<std::int64_t> bad_at{"bad_at", "1", initial = -1, doc = "cycle of the bad value, from 0; -1: none"};
  InConst<std::int32_t> bad{"bad", "1", initial = 0, range(0, 2), doc = "0 NaN, 1 infinity, 2 out of range"};
  InConst<bool> recovers{"recovers", initial = true, doc = "what error() answers"};
  Out<double> command{"command", "N.m", initial = 0.0, range(-1, 1), safety, doc = "0.001 for each cycle"};
  Out<double> plain{"plain", "N.m", initial = 0.0, doc = "the same without guard"};

  void cycle(Cycle) {
    const std::int64_t n = n_++;
    double value = 0.001 * static_cast<double>(n + 1);
    if (n == *bad_at)
      value = *bad == 0   ? std::numeric_limits<double>::quiet_NaN()
              : *bad == 1 ? std::numeric_limits<double>::infinity()
                          : 1.5;
    *command = value;
    *plain = value;
  }
  bool error() { return *recovers; }
  bool clear() { return true; }
  std::int64_t n_ = 0;
};
CHIMERA_COMPONENT(Safety, "t_safety", "A guarded command that goes wrong on demand.", rate = 1000.0);
