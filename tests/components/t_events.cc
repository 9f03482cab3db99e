// SPDX-License-Identifier: Apache-2.0
// An aperiodic component: sync takes an event at every n-th call and says none at the others.
#include <stdexcept>

#include "chimera/task/component.h"

using namespace chimera;

struct Events {
  InConst<std::int64_t> every{"every", "1", initial = 3, doc = "calls of sync for one event"};
  InConst<std::int64_t> throw_at{"throw_at", "1", initial = -1, doc = "the call, from 0, that throws; -1: none"};
  Out<std::int64_t> events{"events", "1", initial = 0, doc = "cycles so far"};
  Out<std::int64_t> calls{"calls", "1", initial = 0, doc = "calls of sync so far"};

  bool sync() {
    const std::int64_t call = calls_++;
    if (call == *throw_at) throw std::runtime_error("no more events");
    return (call + 1) % *every == 0;
  }
  void cycle() {
    ++*events;
    *calls = calls_;
  }
  bool error() { return true; }
  std::int64_t calls_ = 0;
};
CHIMERA_COMPONENT(Events, "t_events", "Takes every n-th event.", rate = 1000.0);
