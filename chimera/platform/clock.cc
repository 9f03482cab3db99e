// SPDX-License-Identifier: Apache-2.0
// Reads the clocks of Linux and sleeps until an instant of CLOCK_MONOTONIC.
#include "chimera/platform/clock.h"

#include <cerrno>
#include <ctime>

namespace chimera {

Nanoseconds LinuxClock::now() noexcept {
  timespec t{};
  ::clock_gettime(CLOCK_MONOTONIC, &t);
  return {t.tv_sec * 1'000'000'000 + t.tv_nsec};
}

WaitEnd LinuxClock::wait_until(Nanoseconds instant) noexcept {
  if (instant.count < 0) return WaitEnd::kReached;  // the kernel refuses a negative time
  const timespec t{instant.count / 1'000'000'000, instant.count % 1'000'000'000};
  const int error = ::clock_nanosleep(CLOCK_MONOTONIC, TIMER_ABSTIME, &t, nullptr);
  CHIMERA_ASSERT(error == 0 || error == EINTR);
  return error == 0 ? WaitEnd::kReached : WaitEnd::kWoken;
}

std::int64_t wall_clock_shift() noexcept {
  timespec wall{}, monotonic{};
  ::clock_gettime(CLOCK_REALTIME, &wall);
  ::clock_gettime(CLOCK_MONOTONIC, &monotonic);
  return (wall.tv_sec - monotonic.tv_sec) * 1'000'000'000 + wall.tv_nsec - monotonic.tv_nsec;
}

Nanoseconds VirtualClock::now() noexcept { return now_; }

WaitEnd VirtualClock::wait_until(Nanoseconds instant) noexcept {
  if (instant > now_) now_ = instant;
  return WaitEnd::kReached;
}

}  // namespace chimera
