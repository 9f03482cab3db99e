// SPDX-License-Identifier: Apache-2.0
// Reads and waits for the SysTick timer.
#include "chimera/platform/bare/bare_clock.h"

#include "chimera/platform/bare/core.h"

namespace chimera::bare {

void BareClock::begin(const TickTime& time) noexcept {
  time_ = time;
  Systick& timer = systick();
  timer.reload = time_.cycles() - 1;
  timer.value = 0;  // any write clears the counter
  timer.control = Systick::kEnable | Systick::kInterrupt | Systick::kProcessorClock;
  while (timer.value == 0) {  // one cycle later it counts from reload
  }
}

// Two words: an interrupt may come between them.
std::uint64_t BareClock::ticks() const noexcept {
  for (std::uint64_t before = ticks_;;) {
    const std::uint64_t after = ticks_;
    if (before == after) return after;
    before = after;
  }
}

Nanoseconds BareClock::now() noexcept {
  for (;;) {
    const std::uint64_t before = ticks();
    const std::uint32_t value = systick().value;
    const bool is_pending = is_systick_pending();
    if (before == ticks()) return time_.at(before, value, is_pending);
  }
}

// With interrupts off, an interrupt after the comparison still ends the sleep. It runs when they are on again.
WaitEnd BareClock::wait_until(Nanoseconds instant) noexcept {
  for (;;) {
    NoInterrupts off;
    if (time_.at(ticks_) >= instant) return WaitEnd::kReached;
    if (is_woken_) {
      is_woken_ = false;
      return WaitEnd::kWoken;
    }
    wait_for_interrupt();
  }
}

}  // namespace chimera::bare
