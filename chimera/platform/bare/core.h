// SPDX-License-Identifier: Apache-2.0
// Registers and instructions that all Cortex-M processors have (ARMv6-M, ARMv7-M).
#pragma once

#include <cstdint>

namespace chimera::bare {

/// A device register at a fixed address.
using Register = volatile std::uint32_t;
inline Register& register_at(std::uintptr_t address) noexcept { return *reinterpret_cast<Register*>(address); }

/// The SysTick timer.
struct Systick {
  Register control, reload, value, calibration;
  static constexpr std::uint32_t kEnable = 1, kInterrupt = 2, kProcessorClock = 4;
};
inline Systick& systick() noexcept { return *reinterpret_cast<Systick*>(0xe000'e010); }

/// Interrupt control and state register: the interrupt of SysTick waits.
inline bool is_systick_pending() noexcept { return (register_at(0xe000'ed04) & (1u << 26)) != 0; }

/// Switches an interrupt of the chip on. `number` counts from the first one behind SysTick.
inline void enable_interrupt(unsigned number) noexcept {
  register_at(0xe000'e100 + 4 * (number / 32)) = 1u << (number % 32);
}

/// Switches an interrupt of the chip off. An interrupt that comes then waits. `number` as for enable_interrupt().
inline void disable_interrupt(unsigned number) noexcept {
  register_at(0xe000'e180 + 4 * (number / 32)) = 1u << (number % 32);
  asm volatile("dsb\n\tisb" ::: "memory");
}

/// The number of the exception that runs, as in ARMv7-M; 16 and above are interrupts of the chip.
inline unsigned running_exception() noexcept {
  std::uint32_t number;
  asm volatile("mrs %0, ipsr" : "=r"(number));
  return number;
}

/// Resets the chip; the RAM keeps its content. Context: any.
[[noreturn]] inline void reset_chip() noexcept {
  asm volatile("dsb" ::: "memory");
  register_at(0xe000'ed0c) = 0x05fa'0004;
  for (;;) asm volatile("dsb" ::: "memory");
}

/// Sleeps until an interrupt waits, also if interrupts are switched off. Context: any; blocks.
inline void wait_for_interrupt() noexcept { asm volatile("dsb\n\twfi" ::: "memory"); }

/// Interrupts are off while an object of this type lives; nested ones are allowed. Context: any; wait-free.
class NoInterrupts {
 public:
  [[gnu::always_inline]] NoInterrupts() noexcept {
    asm volatile("mrs %0, primask\n\tcpsid i" : "=r"(were_off_)::"memory");
  }
  [[gnu::always_inline]] ~NoInterrupts() {
    if (were_off_ == 0) asm volatile("cpsie i" ::: "memory");
  }
  NoInterrupts(const NoInterrupts&) = delete;
  NoInterrupts& operator=(const NoInterrupts&) = delete;

 private:
  std::uint32_t were_off_;
};

}  // namespace chimera::bare
