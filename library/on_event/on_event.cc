// SPDX-License-Identifier: Apache-2.0
// Uses a stated execution time for every event: aperiodic load for schedules and measurements.
#include <cmath>

#include "chimera/task/component.h"

using namespace chimera;

namespace {

struct OnEvent {
  InConst<double> time{"time", "s", range(0, 3600), initial = 0.0, doc = "Execution time for an event."};
  Out<std::int64_t> answered{"answered", "1", initial = 0, doc = "Events so far."};

  Outcome init() { return *time >= 0 && *time <= 3600 ? ok() : fault("time is 0 to 3600 s"); }
  Outcome reinit() { return init(); }
  bool sync() { return true; }  // every call takes one event
  void cycle(Cycle c) {
    c.spend({std::llround(*time * 1e9)});
    *answered += 1;
  }
};

CHIMERA_COMPONENT(OnEvent, "on_event", "Takes a stated execution time for every event.", rate = 100.0);

}  // namespace
