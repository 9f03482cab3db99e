// SPDX-License-Identifier: Apache-2.0
// Checks if a file is a whole shared object for this machine, and which component it has. The loader of the system
// trusts the headers of a file: a truncated file kills the process.
#pragma once

#include <string_view>

#include "chimera/base/message.h"

namespace chimera {

/// Reads the headers of the file behind the descriptor `file`. Empty if the file is whole, without text relocations,
/// and without thread_local variables that are allocated at their first use. Otherwise the fault, as a clause to put
/// after the file name. Context: setup; may block.
Message elf_fault(int file) noexcept;

/// Like elf_fault(file); also checks, without running code of the file, that it offers components and the named one.
/// The symbol must be exported, and the name must be in the file. Context: setup; may block.
Message elf_fault(int file, std::string_view component);

}  // namespace chimera
