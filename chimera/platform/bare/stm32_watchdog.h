// SPDX-License-Identifier: Apache-2.0
// The independent watchdog (IWDG) of the STM32F1 and F4 families. QEMU does not simulate it.
#pragma once

#include <algorithm>
#include <cstdint>

#include "chimera/base/time.h"
#include "chimera/platform/bare/core.h"

namespace chimera::bare {

/// Resets the chip without an interrupt. Its clock of about 40 kHz is inexact: 30 to 60 kHz. Context of everything:
/// any; wait-free.
class Stm32Watchdog {
 public:
  /// The chip does not interrupt: the timer of ticks finds out that the time is over.
  static constexpr bool kInterrupts = false;

  /// Starts it, for ever. The reset comes after four times `time` on the average, so that a tick comes before; at most
  /// 6.5 s.
  void begin(std::uint32_t /*clock_hz*/, Nanoseconds time) noexcept {
    constexpr std::int64_t kStep = 1'600'000;  // ns: 64 periods of 40 kHz
    at().key = kUnlock;
    at().divider = 4;  // by 64
    at().reload = static_cast<std::uint32_t>(std::min<std::int64_t>(4 * time.count / kStep + 1, 4095));
    at().key = kStart;
    stroke();
  }
  void stroke() noexcept { at().key = kStroke; }

 private:
  struct Registers {
    Register key, divider, reload, state;
  };
  static constexpr std::uint32_t kUnlock = 0x5555, kStart = 0xcccc, kStroke = 0xaaaa;
  static Registers& at() noexcept { return *reinterpret_cast<Registers*>(0x4000'3000); }
};

}  // namespace chimera::bare
