// SPDX-License-Identifier: Apache-2.0
// The preemptive executor with real-time levels, on the last CPU.
#pragma once

#include <algorithm>
#include <thread>

#include "chimera/platform/realtime.h"
#include "chimera/runtime/preemptive/preemptive_executor.h"

namespace chimera::toy {

inline constexpr int kCeiling = 49;

inline int last_cpu() { return static_cast<int>(std::max(1u, std::thread::hardware_concurrency())) - 1; }

/// Every level is looked up in the kernel.
inline ProcessorPlace checked_place() {
  ProcessorPlace place;
  place.cpu = last_cpu();
  place.ceiling = kCeiling;
  place.base = 30;
  place.checks = true;
  return place;
}

/// Runs `edges` to its end in a thread at the ceiling, as the cycle boundaries of a context run.
template <class Edges>
void at_the_ceiling(Edges edges) {
  std::thread thread([&edges] {
    (void)enter_realtime({kCeiling, last_cpu(), false});
    edges();
  });
  thread.join();
}

}  // namespace chimera::toy
