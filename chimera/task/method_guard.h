// SPDX-License-Identifier: Apache-2.0
// How a method ends that reads an index beyond a port, where there are no exceptions: it returns at once, with the
// fault that the exception makes on a host. The destructors of local objects of the method and of its callees do not
// run, so a component for a microcontroller must not rely on them; the values in its own members stay as they are.
#pragma once

#include <cstddef>
#include <cstdint>

#include "chimera/task/abi.h"

namespace chimera {

/// A method, or the construction of a component. Returns a CHIMERA_ status.
using GuardedBody = std::int32_t (*)(void* state, const void* argument);

/// Runs `body`. CHIMERA_FAULT with the text in `fault` if it reads an index beyond a port. Context: any; wait-free.
std::int32_t run_guarded(GuardedBody body, void* state, const void* argument, chimera_fault* fault) noexcept;

/// Ends the body that the innermost run_guarded() of this thread runs; without one, the process. Context: any.
[[noreturn]] void leave_guarded(std::size_t index, std::size_t size) noexcept;

}  // namespace chimera
