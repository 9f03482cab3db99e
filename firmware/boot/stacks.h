// SPDX-License-Identifier: Apache-2.0
// The stack of the program and that of interrupts, with a guard below each.
#pragma once

#include "firmware/watch/stack.h"

namespace chimera::firmware {

/// Paints both stacks, and makes the lowest 32 bytes of each read-only if the processor can do that.
/// Context: setup, from a function with a small frame.
void guard_stacks() noexcept;

/// The stack of the program. Context: any; wait-free.
Stack program_stack() noexcept;
/// The stack of interrupts. Context: any; wait-free.
Stack handler_stack() noexcept;
/// The address at which an interrupt interrupted the program. Context: interrupt; wait-free.
std::uint32_t interrupted_program() noexcept;
/// The program is at the guard of its stack, or beyond. Context: exception; wait-free.
bool is_program_stack_overrun() noexcept;

}  // namespace chimera::firmware
