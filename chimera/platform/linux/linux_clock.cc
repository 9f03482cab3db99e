// SPDX-License-Identifier: Apache-2.0
// Reads CLOCK_MONOTONIC and sleeps until an instant of it.
#include "chimera/platform/linux_clock.h"

#include <cerrno>
#include <ctime>

#include "chimera/base/assert.h"

namespace chimera {

Nanoseconds LinuxClock::now() noexcept {
  timespec t{};
  ::clock_gettime(CLOCK_MONOTONIC, &t);
  return {t.tv_sec * 1'000'000'000 + t.tv_nsec};
}

WaitEnd LinuxClock::wait_until(Nanoseconds instant) noexcept {
  if (instant.count < 0) return WaitEnd::kReached;  // the kernel takes no negative time
  const timespec t{instant.count / 1'000'000'000, instant.count % 1'000'000'000};
  const int error = ::clock_nanosleep(CLOCK_MONOTONIC, TIMER_ABSTIME, &t, nullptr);
  CHIMERA_ASSERT(error == 0 || error == EINTR);
  return error == 0 ? WaitEnd::kReached : WaitEnd::kWoken;
}

}  // namespace chimera
