// SPDX-License-Identifier: Apache-2.0
// Where a state variable comes from: a group, and the place of the value in it.
#pragma once

#include <cstddef>
#include <cstdint>

#include "chimera/base/ids.h"
#include "chimera/table/group.h"

namespace chimera {

/// Who produces a variable and where its value stands in the group.
struct Source {
  TaskId task;                ///< invalid: the operator
  std::size_t operator_index = 0;
  std::uint32_t offset = 0;   ///< of the value in the payload
  std::uint32_t bit = 0;      ///< of the value in the valid bits
  GroupReader here{};         ///< the group, where it lies in this context; else not bound
};

/// Both are values of one group.
constexpr bool is_same_group(const Source& a, const Source& b) noexcept {
  return a.task == b.task && (a.task.is_valid() || a.operator_index == b.operator_index);
}

}  // namespace chimera
