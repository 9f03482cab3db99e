// SPDX-License-Identifier: Apache-2.0
// Publishes what Cycle holds, and a count that on() takes over from its former producer.
#include "chimera/task/component.h"

using namespace chimera;

struct Counter {
  Out<std::int64_t> count{"count", "1", initial = 0, doc = "one more in every cycle, going on from where it stood"};
  Out<double> dt{"dt", "s", initial = 0.0};
  Out<std::int64_t> now{"now", "ns", initial = 0};
  Out<std::int64_t> deadline{"deadline", "ns", initial = 0};
  Out<std::int64_t> cycles{"cycles", "1", initial = 0, doc = "completed cycles since on"};
  Out<std::int32_t> dropped{"dropped", "1", initial = 0};
  Out<bool> illegal{"illegal", initial = false};

  void cycle(Cycle c) {
    ++*count;
    *dt = c.dt();
    *now = c.now().count;
    *deadline = c.deadline().count;
    *cycles = static_cast<std::int64_t>(c.count());
    *dropped = static_cast<std::int32_t>(c.dropped());
    *illegal = c.illegal();
  }
};
CHIMERA_COMPONENT(Counter, "t_counter", "Publishes the arguments of its cycle.", rate = 1000.0);
