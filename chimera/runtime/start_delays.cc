// SPDX-License-Identifier: Apache-2.0
// Tells start delays from what was added to a profile since.
#include "chimera/runtime/start_delays.h"

namespace chimera {

Nanoseconds StartDelays::begin(const Task& task) noexcept {
  const Spread now = seen_[task.id.index] = task.profile.start_delay;
  return now.count == 0 ? Nanoseconds{-1} : now.max;
}

Nanoseconds StartDelays::look(const Task& task) noexcept {
  Spread& seen = seen_[task.id.index];
  if (seen.count == kNotBegun) return (void)begin(task), Nanoseconds{-1};
  const Spread before = seen, now = seen = task.profile.start_delay;
  if (now.count <= before.count) return Nanoseconds{-1};  // spawned anew: it begins at 0
  if (before.count == 0 || now.max > before.max) return now.max;
  return Nanoseconds{(now.sum - before.sum).count / static_cast<std::int64_t>(now.count - before.count)};
}

}  // namespace chimera
