// SPDX-License-Identifier: Apache-2.0
// Counts what the program asks of the heap, whoever asks: the program, its libraries, a shared object without source.
// A program that calls one of these has its malloc counted (under the address sanitizer by the sanitizer's hooks).
#pragma once

#include <cstdint>

namespace chimera {

/// From now on allocations and frees of the process are counted. Context: setup.
void watch_allocations() noexcept;
/// Allocations of this thread since watch_allocations(); only differences mean something. Context: any; wait-free.
std::uint64_t allocations_of_this_thread() noexcept;
/// Blocks allocated and not freed, over all threads; only differences mean something. Context: any; wait-free.
std::int64_t live_allocations() noexcept;

}  // namespace chimera
