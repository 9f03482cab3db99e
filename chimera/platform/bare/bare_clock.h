// SPDX-License-Identifier: Apache-2.0
// The clock of a Cortex-M processor without an operating system: the SysTick timer and the number of its interrupts.
#pragma once

#include <cstdint>

#include "chimera/platform/bare/tick_time.h"
#include "chimera/platform/clock.h"

namespace chimera::bare {

/// Time since begin(), exact to the cycle of the timer. A wait ends at the first tick at or after its instant.
class BareClock final : public Clock {
 public:
  /// Starts the timer and its interrupt. Nothing else may be called before. Context: setup.
  void begin(const TickTime& time) noexcept;
  /// Call from the interrupt of SysTick. Context: interrupt; wait-free.
  void on_tick() noexcept { ticks_ = ticks_ + 1; }
  /// The present or next wait ends early: WaitEnd::kWoken. Context: interrupt, cycle; wait-free.
  void wake() noexcept { is_woken_ = true; }

  Nanoseconds now() noexcept override;
  WaitEnd wait_until(Nanoseconds instant) noexcept override;

  /// The instant of the latest tick. Context: cycle; wait-free.
  Nanoseconds last_tick() const noexcept { return time_.at(ticks()); }
  Nanoseconds tick() const noexcept { return time_.tick(); }

 private:
  std::uint64_t ticks() const noexcept;

  TickTime time_;
  volatile std::uint64_t ticks_ = 0;  // written by the interrupt
  volatile bool is_woken_ = false;
};

}  // namespace chimera::bare
