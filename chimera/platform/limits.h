// SPDX-License-Identifier: Apache-2.0
// Limits of the shell or the service (ulimit, LimitSTACK=) under which nothing here can run: told by name before a
// process dies of one without a word.
#pragma once

#include "chimera/base/result.h"

namespace chimera {

inline constexpr std::uint64_t kLeastStack = 256 << 10;  ///< of a first thread; those of real-time units have as much
inline constexpr std::uint64_t kLeastMemoryFile = 4 << 20;  ///< shared memory counts as a file

/// Refuses a stack below kLeastStack: everybody needs it. Context: setup.
Result<void> may_run_here() noexcept;
/// Refuses a size of files below kLeastMemoryFile: processes share memory. Context: setup.
Result<void> may_share_memory_here() noexcept;

}  // namespace chimera
