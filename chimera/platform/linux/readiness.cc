// SPDX-License-Identifier: Apache-2.0
// Waits for descriptors by ppoll, whose limit is as fine as our time.
#include "chimera/platform/readiness.h"

#include <poll.h>

#include <algorithm>

#include "chimera/base/assert.h"

namespace chimera {
namespace {

constexpr std::size_t kMost = 64;

int wait_for(pollfd* events, std::size_t n, Nanoseconds limit) noexcept {
  const Nanoseconds left = std::max(limit, Nanoseconds{0});
  const timespec patience{left.count / 1'000'000'000, left.count % 1'000'000'000};
  return ::ppoll(events, n, limit == kNever ? nullptr : &patience, nullptr);
}

}  // namespace

bool await_readable(std::span<const int> descriptors, Nanoseconds limit) noexcept {
  CHIMERA_ASSERT(descriptors.size() <= kMost);
  pollfd events[kMost];
  for (std::size_t i = 0; i < descriptors.size(); ++i) events[i] = {descriptors[i], POLLIN, 0};
  return wait_for(events, descriptors.size(), limit) > 0;
}

int await_ready(std::span<Watched> watched, Nanoseconds limit) noexcept {
  CHIMERA_ASSERT(watched.size() <= kMost);
  pollfd events[kMost];
  for (std::size_t i = 0; i < watched.size(); ++i)
    events[i] = {watched[i].descriptor, static_cast<short>(watched[i].for_room ? POLLOUT : POLLIN), 0};
  const int found = wait_for(events, watched.size(), limit);
  for (std::size_t i = 0; i < watched.size(); ++i) {
    watched[i].is_ready = found > 0 && events[i].revents != 0;
    watched[i].is_lost = found > 0 && (events[i].revents & POLLNVAL) != 0;
  }
  return found;
}

}  // namespace chimera
