// SPDX-License-Identifier: Apache-2.0
// The watchdog of Arm's Cortex-M system design kit, which the MPS2 boards have.
#pragma once

#include <cstdint>

#include "chimera/base/time.h"
#include "chimera/platform/bare/core.h"

namespace chimera::bare {

/// The first end of its time is a non-maskable interrupt, the second resets the chip. Context of everything: any;
/// wait-free.
class CmsdkWatchdog {
 public:
  /// The chip interrupts by itself when the time is over.
  static constexpr bool kInterrupts = true;

  /// Starts it. `time` at most 2^32 cycles of the clock.
  void begin(std::uint32_t clock_hz, Nanoseconds time) noexcept {
    at().lock = kUnlock;
    at().load = static_cast<std::uint32_t>(time.count * clock_hz / seconds(1).count);
    at().control = kInterruptOn | kResetOn;
    at().lock = 0;
  }
  /// Begins the time anew, also after its first end.
  void stroke() noexcept {
    at().lock = kUnlock;
    at().clear = 1;
    at().lock = 0;
  }

 private:
  struct Registers {
    Register load, value, control, clear, raw_state, state;
    std::uint32_t unused[0x2fa];
    Register lock;
  };
  static constexpr std::uint32_t kInterruptOn = 1, kResetOn = 2, kUnlock = 0x1acc'e551;
  static Registers& at() noexcept { return *reinterpret_cast<Registers*>(0x4000'8000); }
  static_assert(sizeof(Registers) == 0xc04);
};

}  // namespace chimera::bare
