// SPDX-License-Identifier: Apache-2.0
// The watchdog of the chip. Where the chip resets without an interrupt, the timer of ticks looks at the time before.
#pragma once

#include <atomic>
#include <cstdint>

#include "chimera/base/time.h"
#include "firmware/watch/watchdog.h"
#include CHIMERA_BOARD

namespace chimera::firmware {

/// Context of everything not marked: any; wait-free.
class BoardWatchdog final : public WatchdogPort {
 public:
  /// From now on the image must stroke it. `time` is at least one tick. Context: setup.
  void begin(std::uint32_t clock_hz, Nanoseconds time, Nanoseconds tick) noexcept {
    allowed_ = static_cast<std::uint32_t>(time / tick);
    timer_.begin(clock_hz, time);
  }
  void stroke() noexcept override {
    timer_.stroke();
    passed_.store(0, std::memory_order_relaxed);
  }
  /// True if the time is over and the chip does not interrupt by itself. Context: interrupt of the tick.
  bool is_over_at_tick() noexcept {
    if constexpr (WatchdogTimer::kInterrupts) return false;
    if (allowed_ == 0) return false;
    const std::uint32_t passed = passed_.load(std::memory_order_relaxed) + 1;
    passed_.store(passed, std::memory_order_relaxed);
    return passed > allowed_;
  }

 private:
  WatchdogTimer timer_;
  std::uint32_t allowed_ = 0;              // ticks; 0: not begun
  std::atomic<std::uint32_t> passed_{0};  // ticks since the last stroke; relaxed, pairs with nothing
};

}  // namespace chimera::firmware
