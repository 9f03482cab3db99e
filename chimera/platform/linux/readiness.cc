// SPDX-License-Identifier: Apache-2.0
// Waits for descriptors by ppoll, whose limit is as fine as our time.
#include "chimera/platform/readiness.h"

#include <poll.h>

#include <algorithm>

#include "chimera/base/assert.h"

namespace chimera {

bool await_readable(std::span<const int> descriptors, Nanoseconds limit) noexcept {
  constexpr std::size_t kMost = 64;
  CHIMERA_ASSERT(descriptors.size() <= kMost);
  pollfd events[kMost];
  for (std::size_t i = 0; i < descriptors.size(); ++i) events[i] = {descriptors[i], POLLIN, 0};
  const Nanoseconds left = std::max(limit, Nanoseconds{0});
  const timespec patience{left.count / 1'000'000'000, left.count % 1'000'000'000};
  return ::ppoll(events, descriptors.size(), limit == kNever ? nullptr : &patience, nullptr) > 0;
}

}  // namespace chimera
