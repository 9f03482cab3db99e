// SPDX-License-Identifier: Apache-2.0
// Does the work of the idle time in small pieces.
#include "firmware/idle_clock.h"

#include <algorithm>

#include "firmware/boards/board.h"
#include "firmware/boot/kept.h"

namespace chimera::firmware {

void IdleClock::tick(Nanoseconds now) noexcept {
  next_tick_ = clock_.last_tick() + clock_.tick();
  served_.watchdog->tick(now);
}

WaitEnd IdleClock::wait_until(Nanoseconds instant) noexcept {
  job_word.store(0, std::memory_order_relaxed);
  if constexpr (mechanisms::kShell) served_.listener->look(clock_.now());
  for (;;) {
    const Nanoseconds now = this->now();
    if (now >= instant) return WaitEnd::kReached;
    if constexpr (mechanisms::kShell) {
      if (served_.listener->is_due(now)) return WaitEnd::kWoken;
      if (served_.shell->has_work()) {
        served_.shell->step(now);
        uart().go_on();
        continue;
      }
    }
    clock_.wait_until(mechanisms::kWatchdog ? std::min(instant, next_tick_) : instant);
  }
}

}  // namespace chimera::firmware
