// SPDX-License-Identifier: Apache-2.0
// Both stacks lie at the end of the RAM, that of interrupts above that of the program (image.ld).
#include "firmware/boot/stacks.h"

#include <cstdint>

#include "chimera/platform/bare/core.h"

extern "C" std::uint32_t image_stack_begin[], image_stack_end[], image_handler_stack_begin[], image_handler_stack_end[];

namespace chimera::firmware {
namespace {

constexpr std::uint32_t kPattern = 0xc5c5'c5c5;
constexpr std::uint32_t kGuardBytes = 32;

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

void fill(std::uint32_t* begin, std::uint32_t end) noexcept {
  constexpr std::uint32_t kFrameOfCaller = 64;
  for (volatile std::uint32_t* at = begin; reinterpret_cast<std::uintptr_t>(at) < end - kFrameOfCaller; ++at)
    *at = kPattern;
}

// Memory protection unit of ARMv6-M and ARMv7-M: one region of 32 bytes, privileged read-only, never executed.
void protect(std::uint32_t region, const std::uint32_t* begin) noexcept {
  constexpr std::uint32_t kNeverExecuted = 1u << 28, kReadOnly = 5u << 24, kBytes32 = 4u << 1, kEnable = 1;
  bare::register_at(0xe000'ed98) = region;
  bare::register_at(0xe000'ed9c) = reinterpret_cast<std::uintptr_t>(begin);
  bare::register_at(0xe000'eda0) = kNeverExecuted | kReadOnly | kBytes32 | kEnable;
}

StackUse use_of(const std::uint32_t* begin, const std::uint32_t* end) noexcept {
  const std::uint32_t* at = begin;
  while (at < end && *at == kPattern) ++at;
  const auto bytes = [](const std::uint32_t* from, const std::uint32_t* to) {
    return static_cast<std::size_t>(to - from) * sizeof *from;
  };
  return {bytes(at, end), bytes(begin, end), at != begin};
}

}  // namespace

void guard_stacks() noexcept {
  fill(image_stack_begin, program_stack_pointer());
  fill(image_handler_stack_begin, handler_stack_pointer() + 64);
  constexpr std::uint32_t kDefaultMap = 4, kEnable = 1;
  const std::uint32_t regions = bare::register_at(0xe000'ed90) >> 8 & 0xff;
  if (regions < 2) return;
  protect(0, image_stack_begin);
  protect(1, image_handler_stack_begin);
  bare::register_at(0xe000'ed94) = kDefaultMap | kEnable;
  asm volatile("dsb\n\tisb" ::: "memory");
}

StackUse program_stack() noexcept { return use_of(image_stack_begin, image_stack_end); }
StackUse handler_stack() noexcept { return use_of(image_handler_stack_begin, image_handler_stack_end); }
bool is_program_stack_overrun() noexcept {
  return program_stack_pointer() < reinterpret_cast<std::uintptr_t>(image_stack_begin) + kGuardBytes;
}

}  // namespace chimera::firmware
