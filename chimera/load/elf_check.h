// SPDX-License-Identifier: Apache-2.0
// Whether a file is a whole shared object for this machine. The system's loader trusts the headers of a file: one that
// was cut short kills the process instead of being refused.
#pragma once

#include <string_view>

namespace chimera {

/// Reads the headers of the file behind the descriptor `file`. "" when it is whole, else why not, as a clause that
/// goes after the file's name. Context: setup; may block.
std::string_view elf_fault(int file) noexcept;

}  // namespace chimera
