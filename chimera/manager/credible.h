// SPDX-License-Identifier: Apache-2.0
// What a real-time unit counted, read from memory that a stray pointer of its components may have written over.
#pragma once

#include <algorithm>
#include <cstdint>

#include "chimera/base/time.h"
#include "chimera/task/abi.h"
#include "chimera/task/task.h"
#include "chimera/units/quantity.h"

namespace chimera::manager {

/// Could these be counts of a subsystem that runs for `age`? Nothing is counted faster than the shortest period, times
/// the inputs of a cycle. Context: any; wait-free.
inline bool is_credible(const Profile& counted, Nanoseconds age) noexcept {
  const std::int64_t cycles = std::max<std::int64_t>((age + seconds(1)).count, 0) / kShortestPeriod.count;
  const auto most = static_cast<std::uint64_t>(cycles) * CHIMERA_MAX_PORTS;
  for (const std::uint64_t count : {counted.missed, counted.overrun, counted.stale, counted.dropped})
    if (count > most) return false;
  return true;
}

}  // namespace chimera::manager
