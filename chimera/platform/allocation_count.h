// SPDX-License-Identifier: Apache-2.0
// Counts allocations of the program, of its libraries, and of shared objects without source. The malloc of a program
// that calls one of these functions is counted (under the address sanitizer by the sanitizer's hooks).
#pragma once

#include <cstdint>

namespace chimera {

/// Counts allocations and frees of the process from now on. Context: setup.
void watch_allocations() noexcept;
/// Allocations of this thread since watch_allocations(); only differences mean something. Context: any; wait-free.
std::uint64_t allocations_of_this_thread() noexcept;
/// Blocks allocated and not freed, over all threads; only differences mean something. Context: any; wait-free.
std::int64_t live_allocations() noexcept;

}  // namespace chimera
