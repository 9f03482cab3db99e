// SPDX-License-Identifier: Apache-2.0
// For the tests of signal components: a rig whose signals have one element until said.
#pragma once

#include "chimera/task/rig.h"

namespace chimera {

struct SignalRig : Rig {
  explicit SignalRig(const char* component, std::uint32_t elements = 1) : Rig(component) { extent("n", elements); }

  /// The output for the next input. A fault shows as NaN.
  double step(double x, Nanoseconds dt = milliseconds(1)) {
    set("x", x);
    return cycle(dt) ? get<double>("y") : std::nan("");
  }
};

}  // namespace chimera
