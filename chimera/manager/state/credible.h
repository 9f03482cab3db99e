// SPDX-License-Identifier: Apache-2.0
// The counts of an rtpu, read from memory that a stray pointer of its components may have overwritten.
#pragma once

#include <algorithm>
#include <cstdint>
#include <iterator>

#include "chimera/base/time.h"
#include "chimera/task/abi.h"
#include "chimera/task/fault_record.h"
#include "chimera/task/task.h"
#include "chimera/units/quantity.h"

namespace chimera::manager {

/// The longest duration in a subsystem that runs for `age`, with a second for clocks. Context: any; wait-free.
inline std::int64_t longest_in(Nanoseconds age) noexcept { return std::max<std::int64_t>((age + seconds(1)).count, 0); }
/// The highest count: none grows faster than the shortest period allows, times the inputs of a cycle. Context: any;
/// wait-free.
inline std::uint64_t most_in(Nanoseconds age) noexcept {
  return static_cast<std::uint64_t>(longest_in(age) / kShortestPeriod.count) * CHIMERA_MAX_PORTS;
}

/// True if a fault of a subsystem that began at `origin` can be this one. Context: any; wait-free.
inline bool is_credible(const FaultRecord& fault, Nanoseconds origin, Nanoseconds now) noexcept {
  const std::uint64_t most = most_in(now - origin);
  const bool has_method = static_cast<std::uint32_t>(fault.method) < CHIMERA_METHODS &&
                          static_cast<std::uint32_t>(fault.off_method) < CHIMERA_METHODS;
  return has_method && fault.count <= most && fault.notes <= most && fault.off_count <= most &&
         fault.at.count >= 0 && fault.at <= now + seconds(1);
}

/// True if these can be counts of a subsystem that runs for `age`. Context: any; wait-free.
inline bool is_credible(const Profile& counted, Nanoseconds age) noexcept {
  const std::int64_t longest = longest_in(age);
  const std::uint64_t most = most_in(age);
  for (const std::uint64_t count : {counted.missed, counted.overrun, counted.stale, counted.dropped})
    if (count > most) return false;
  const auto is_duration = [&](Nanoseconds took) { return took.count >= -longest && took.count <= longest; };
  const auto is_spread = [&](const Spread& spread) {
    const bool has_values = spread.min <= spread.max;  // if false: no value yet, or the first one is being added
    return spread.count <= most && (!has_values || (is_duration(spread.min) && is_duration(spread.max)));
  };
  return is_spread(counted.response) && is_spread(counted.start_delay) &&
         std::all_of(std::begin(counted.execution), std::end(counted.execution), is_spread) &&
         std::all_of(std::begin(counted.late), std::end(counted.late), is_duration) &&
         (counted.on_since == kNever || counted.on_since.count >= 0) && is_duration(counted.on_before);
}

/// Empties a spread that counts its first value but does not contain it yet. Context: any; wait-free.
inline Spread whole(const Spread& spread) noexcept { return spread.min <= spread.max ? spread : Spread{}; }

/// The counts of `read` if they are credible; empty counts if not. Context: any; wait-free.
inline Profile credible(const Profile& read, Nanoseconds age) noexcept {
  if (!is_credible(read, age)) return {};
  Profile counted = read;
  counted.response = whole(counted.response);
  counted.start_delay = whole(counted.start_delay);
  std::transform(std::begin(counted.execution), std::end(counted.execution), std::begin(counted.execution), whole);
  return counted;
}

}  // namespace chimera::manager
