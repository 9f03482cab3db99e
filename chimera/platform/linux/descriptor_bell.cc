// SPDX-License-Identifier: Apache-2.0
// Waits by poll for a descriptor and for an eventfd, which is the bell.
#include "chimera/platform/descriptor_bell.h"

#include <poll.h>
#include <sys/eventfd.h>
#include <unistd.h>

#include <algorithm>
#include <ctime>

#include "chimera/platform/linux_clock.h"
#include "chimera/platform/lost_descriptor.h"

namespace chimera {

DescriptorBell::DescriptorBell() noexcept : event_(::eventfd(0, EFD_NONBLOCK | EFD_CLOEXEC)) {}

void DescriptorBell::ring() noexcept {
  const std::uint64_t one = 1;
  if (::write(event_.fd, &one, sizeof one) < 0) return;  // it rings already
}

bool DescriptorBell::await(int descriptor, Nanoseconds instant) noexcept {
  const Nanoseconds left = instant == kNever ? kNever : std::max(instant - LinuxClock().now(), Nanoseconds{});
  const timespec t{left.count / 1'000'000'000, left.count % 1'000'000'000};
  pollfd both[] = {{descriptor, POLLIN, 0}, {event_.fd, POLLIN, 0}};
  if (::ppoll(both, 2, instant == kNever ? nullptr : &t, nullptr) <= 0) return false;
  if ((both[1].revents & POLLNVAL) != 0) end_without_descriptor();
  std::uint64_t rings = 0;
  if (both[1].revents != 0 && ::read(event_.fd, &rings, sizeof rings) < 0) return false;
  return both[0].revents != 0;
}

}  // namespace chimera
