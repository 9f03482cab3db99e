// SPDX-License-Identifier: Apache-2.0
// Both stacks lie at the begin of the RAM, that of interrupts above that of the program (image.ld).
#include "firmware/boot/stacks.h"

#include <cstdint>

#include "chimera/platform/bare/core.h"

extern "C" std::uint32_t image_stack_begin[], image_stack_end[], image_handler_stack_begin[], image_handler_stack_end[];

namespace chimera::firmware {
namespace {

std::uint32_t program_stack_pointer() noexcept {
  std::uint32_t at;
  asm volatile("mrs %0, psp" : "=r"(at));
  return at;
}
std::uint32_t handler_stack_pointer() noexcept {
  std::uint32_t at;
  asm volatile("mrs %0, msp" : "=r"(at));
  return at;
}

// Memory protection unit of ARMv6-M and ARMv7-M: 32 bytes, privileged read-only, never executed. The smallest region of
// ARMv6-M has 256 bytes in eight parts; all parts but one are left out of it.
void protect(std::uint32_t region, const std::uint32_t* begin) noexcept {
  constexpr std::uint32_t kNeverExecuted = 1u << 28, kReadOnly = 5u << 24, kBytes256 = 7u << 1, kEnable = 1;
  const auto address = reinterpret_cast<std::uintptr_t>(begin);
  const std::uint32_t left_out = 0xffu & ~(1u << (address >> 5 & 7));
  bare::register_at(0xe000'ed98) = region;
  bare::register_at(0xe000'ed9c) = address & ~255u;
  bare::register_at(0xe000'eda0) = kNeverExecuted | kReadOnly | left_out << 8 | kBytes256 | kEnable;
}

}  // namespace

void guard_stacks() noexcept {
  // Words near the pointer are those of this function and of paint().
  constexpr std::uint32_t kOwnBytes = 64;
  paint({image_stack_begin, reinterpret_cast<std::uint32_t*>(program_stack_pointer() - kOwnBytes)});
  paint({image_handler_stack_begin, reinterpret_cast<std::uint32_t*>(handler_stack_pointer())});
  constexpr std::uint32_t kDefaultMap = 4, kEnable = 1;
  // Faults of their own: one whose frame finds no room on the stack ends in the hard fault, and does not lock up.
  bare::register_at(0xe000'ed24) |= 7u << 16;
  const std::uint32_t regions = bare::register_at(0xe000'ed90) >> 8 & 0xff;
  if (regions < 1) return;
  protect(0, image_handler_stack_begin);
  bare::register_at(0xe000'ed94) = kDefaultMap | kEnable;
  asm volatile("dsb\n\tisb" ::: "memory");
}

Stack program_stack() noexcept { return {"program", {image_stack_begin, image_stack_end}}; }
Stack handler_stack() noexcept { return {"handlers", {image_handler_stack_begin, image_handler_stack_end}}; }
// The processor stored r0 to r3, r12, lr, pc and xpsr.
std::uint32_t interrupted_program() noexcept {
  return reinterpret_cast<const std::uint32_t*>(program_stack_pointer())[6];
}

// The frame of an exception takes 32 bytes below the pointer. If they reach below the RAM, the processor notes that
// (ARMv7-M), and moves the pointer all the same.
bool is_program_stack_overrun() noexcept {
  if (program_stack_pointer() < reinterpret_cast<std::uintptr_t>(image_stack_begin + kGuardWords)) return true;
#if __ARM_ARCH >= 7
  constexpr std::uint32_t kStackingFailed = 1u << 12;
  return (bare::register_at(0xe000'ed28) & kStackingFailed) != 0;
#else
  return false;
#endif
}

}  // namespace chimera::firmware
