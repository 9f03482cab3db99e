// SPDX-License-Identifier: Apache-2.0
// Uses a stated execution time in every cycle: task sets of schedules, load for measurements.
#include <cmath>

#include "chimera/task/component.h"

using namespace chimera;

namespace {

struct Busy {
  InConst<double> time{"time", "s", range(0, 3600), doc = "Execution time of a cycle."};

  Outcome init() { return *time >= 0 && *time <= 3600 ? ok() : fault("time is 0 to 3600 s"); }
  Outcome reinit() { return init(); }
  void cycle(Cycle c) { c.spend({std::llround(*time * 1e9)}); }
};

CHIMERA_COMPONENT(Busy, "busy", "Takes a stated execution time in every cycle.");

}  // namespace
