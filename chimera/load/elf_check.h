// SPDX-License-Identifier: Apache-2.0
// Whether a file is a whole shared object for this machine, and of which component. The system's loader trusts the
// headers of a file: one that was cut short kills the process instead of being refused.
#pragma once

#include <string_view>

#include "chimera/base/message.h"

namespace chimera {

/// Reads the headers of the file behind the descriptor `file`. Empty when it is whole and has neither text relocations
/// nor thread_local variables that are made at their first use, else what is wrong, as a clause that goes after the
/// file's name. Context: setup; may block.
Message elf_fault(int file) noexcept;

/// As elf_fault(file), and whether the file offers components, and one of that name, as far as that is seen without
/// running code of the file: the symbol is exported, and the name stands in the file. Context: setup; may block.
Message elf_fault(int file, std::string_view component);

}  // namespace chimera
