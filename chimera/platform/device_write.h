// SPDX-License-Identifier: Apache-2.0
// Writing to a device in the place of a process that is dead.
#pragma once

#include <cstddef>
#include <span>

namespace chimera {

/// What is written to `descriptor` from now on waits for nobody, and what its dead owner left in the queue of a
/// terminal is dropped. Requires: nobody else uses what it names. Context: any; a few system calls that do not wait.
void take_over_device(int descriptor) noexcept;

/// Bytes that were taken; 0: none for now; -1: it takes none any more. Context: any; one system call that does not
/// wait.
int write_device(int descriptor, std::span<const std::byte> bytes) noexcept;

}  // namespace chimera
