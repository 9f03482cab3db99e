// SPDX-License-Identifier: Apache-2.0
// Wakes by an eventfd that never blocks.
#include "chimera/platform/wake_event.h"

#include <sys/eventfd.h>
#include <unistd.h>

#include <cstdint>

namespace chimera {

void ring_event(int descriptor) noexcept {
  const std::uint64_t one = 1;
  // A counter that is full is readable already: nothing is lost by not adding to it.
  [[maybe_unused]] const ssize_t written = ::write(descriptor, &one, sizeof one);
}

Result<WakeEvent> WakeEvent::open(const Message& what) noexcept {
  OwnedDescriptor event(::eventfd(0, EFD_CLOEXEC | EFD_NONBLOCK));
  if (event.fd < 0) return system_error(what, "eventfd");
  return WakeEvent(std::move(event));
}

void WakeEvent::reset() const noexcept {
  std::uint64_t count = 0;
  [[maybe_unused]] const ssize_t got = ::read(event_.fd, &count, sizeof count);  // nothing to read: it did not ring
}

}  // namespace chimera
