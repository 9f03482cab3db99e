// SPDX-License-Identifier: Apache-2.0
// Sends one signal to another task, or to itself, in a stated cycle.
#include "chimera/task/component.h"

using namespace chimera;

struct Sender {
  InConst<Text<64>> target{"target", initial = "", doc = "a task; empty: itself"};
  InConst<std::int32_t> what{"what", "1", initial = CHIMERA_SIGNAL_OFF, doc = "the number of the signal"};
  InConst<std::int64_t> at{"at", "1", initial = 0, doc = "the cycle, from 0"};
  Out<std::int32_t> sent{"sent", "1", initial = 0, doc = "0 not yet, 1 accepted, -1 refused"};

  void cycle(Cycle c) {
    if (n_++ != *at) return;
    *sent = c.signal(static_cast<Signal>(*what), target->empty() ? nullptr : target->c_str()) ? 1 : -1;
  }
  std::int64_t n_ = 0;
};
CHIMERA_COMPONENT(Sender, "t_sender", "Sends a signal.", rate = 1000.0);
