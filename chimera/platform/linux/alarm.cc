// SPDX-License-Identifier: Apache-2.0
// An alarm is a timer of the kernel whose instant another thread may change.
#include "chimera/platform/alarm.h"

#include <sys/timerfd.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstdint>

#include "chimera/platform/lost_descriptor.h"

namespace chimera {

Alarm::Alarm() noexcept : timer_{::timerfd_create(CLOCK_MONOTONIC, TFD_CLOEXEC)} {}

void Alarm::set(Nanoseconds instant) noexcept {
  itimerspec when{};
  if (instant != kNever) {
    const std::int64_t ns = std::max<std::int64_t>(instant.count, 1);  // zero would switch it off
    when.it_value = {ns / 1'000'000'000, ns % 1'000'000'000};
  }
  // Whoever waits holds what was closed: he would sleep on, and nobody else would know.
  if (::timerfd_settime(timer_.fd, TFD_TIMER_ABSTIME, &when, nullptr) != 0) end_without_descriptor();
}

void Alarm::wait() noexcept {
  std::uint64_t times = 0;
  while (::read(timer_.fd, &times, sizeof times) < 0)
    if (errno != EINTR) end_without_descriptor();  // else a signal handler ran
}

}  // namespace chimera
