// SPDX-License-Identifier: Apache-2.0
// A shared object of code: copied into sealed memory, and linked into this process forever.
#pragma once

#include <span>
#include <string>

#include "chimera/base/result.h"
#include "chimera/platform/descriptor.h"

namespace chimera {

/// A copy in memory of the open file `from`, sealed against every change. `name` shows in /proc only. Refuses with the
/// system's reason and `path` in `where`. Context: setup; may block.
Result<OwnedDescriptor> sealed_copy(int from, const char* name, const std::string& path) noexcept;

/// A sealed copy of bytes in memory. Context: setup; may block.
Result<OwnedDescriptor> sealed_copy(std::span<const std::byte> from, const char* name,
                                    const std::string& path) noexcept;

/// Links the object behind `descriptor` and runs its static constructors. The descriptor stays open forever: the linker
/// knows an object by its path in /proc, so a second object must not get this number. Refuses with the
/// linker's reason (kBadInput). Context: setup; may block.
Result<void*> link_object(OwnedDescriptor descriptor);

/// The address of a symbol of the object; nullptr if there is none. Context: setup.
void* symbol_of(void* object, const char* name) noexcept;

}  // namespace chimera
