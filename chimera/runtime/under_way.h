// SPDX-License-Identifier: Apache-2.0
// The words of a block that say what is under way: BlockHead::running, serving, at_edge, background.
#pragma once

#include <cstdint>

#include "chimera/base/ids.h"

namespace chimera {

/// In place of a method, where a task's object is opened, and where its background runs.
inline constexpr std::uint32_t kOpening = 254, kInBackground = 255;

/// `method` of `task`. 0 is none.
constexpr std::uint32_t under_way(TaskId task, std::uint32_t method) noexcept { return (task.index + 1) << 8 | method; }

}  // namespace chimera
