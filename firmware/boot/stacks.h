// SPDX-License-Identifier: Apache-2.0
// The stack of the program and that of interrupts: how far they were used, and a guard below each.
#pragma once

#include <cstddef>

namespace chimera::firmware {

/// Bytes of one stack.
struct StackUse {
  std::size_t used = 0;  ///< the deepest use so far
  std::size_t size = 0;
  bool is_whole = true;  ///< false: it was used to its last word
};

/// Fills both stacks with a pattern, and makes the lowest 32 bytes of each read-only if the processor can do that.
/// Context: setup, from a function with a small frame.
void guard_stacks() noexcept;

/// Use of the stack of the program. Context: any; O(size).
StackUse program_stack() noexcept;
/// Use of the stack of interrupts. Context: any; O(size).
StackUse handler_stack() noexcept;
/// The program is at the guard of its stack, or beyond. Context: exception; wait-free.
bool is_program_stack_overrun() noexcept;

}  // namespace chimera::firmware
