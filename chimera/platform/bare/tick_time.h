// SPDX-License-Identifier: Apache-2.0
// Time from a timer that counts the cycles of a tick down, and from the number of ticks.
#pragma once

#include <cstdint>

#include "chimera/base/assert.h"
#include "chimera/base/time.h"

namespace chimera::bare {

/// Converts readings of the SysTick timer to time since its start. Context of everything: any; wait-free.
class TickTime {
 public:
  constexpr TickTime() noexcept = default;
  /// `clock_hz` is the rate of the timer, 4 MHz to 1 GHz. `tick` is a whole number of its cycles, at most 2^24.
  constexpr TickTime(std::uint32_t clock_hz, Nanoseconds tick) noexcept
      : tick_(tick),
        cycles_(static_cast<std::uint32_t>(tick.count * clock_hz / seconds(1).count)),
        scale_(static_cast<std::uint32_t>(((seconds(1).count << kShift) + clock_hz - 1) / clock_hz)) {
    CHIMERA_ASSERT(clock_hz >= 4'000'000 && clock_hz <= 1'000'000'000);
    CHIMERA_ASSERT(cycles_ >= 2 && cycles_ <= (1u << 24));
    CHIMERA_ASSERT(cycles_ * seconds(1).count == tick.count * clock_hz);
  }

  Nanoseconds tick() const noexcept { return tick_; }
  /// Cycles of one tick. The register RELOAD holds one less.
  std::uint32_t cycles() const noexcept { return cycles_; }
  /// The instant of tick number `ticks`.
  Nanoseconds at(std::uint64_t ticks) const noexcept { return tick_ * static_cast<std::int64_t>(ticks); }
  /// The instant of a reading: `ticks` were counted, and the counter, which goes from cycles() - 1 down to 0, shows
  /// `value`. `is_pending`: the interrupt of one more tick waited after `value` was read.
  Nanoseconds at(std::uint64_t ticks, std::uint32_t value, bool is_pending) const noexcept {
    // A tick is due when the counter reaches 0. A small value with a waiting interrupt was read before the tick.
    if (is_pending && value > cycles_ / 2) ++ticks;
    const std::uint32_t gone = value < cycles_ ? cycles_ - value : 0;
    return at(ticks) + Nanoseconds{static_cast<std::int64_t>((std::uint64_t{gone} * scale_) >> kShift)};
  }

 private:
  static constexpr int kShift = 24;

  Nanoseconds tick_;
  std::uint32_t cycles_ = 0;
  std::uint32_t scale_ = 0;  // ns of a cycle, times 2^24, rounded up: multiples of a cycle never lose their last ns
};

}  // namespace chimera::bare
