// SPDX-License-Identifier: Apache-2.0
// The value of a state variable, as the thread of its context and as other threads find it.
#pragma once

#include <cstddef>
#include <cstdint>

#include "chimera/table/group.h"
#include "chimera/task/task_spec.h"

namespace chimera {

/// Present value of a state variable.
struct VariableView {
  const std::byte* value = nullptr;  ///< of the latest publication; nullptr: never bound
  const chimera_slot* slot = nullptr;
  const PortSpec* spec = nullptr;    ///< of the producing port; nullptr for operator variables
  std::uint32_t count = 0;
  bool is_valid = false;
};

/// A group in which a variable's value may stand.
struct VariableReader {
  GroupReader reader;
  std::uint32_t offset = 0;  ///< of the value in the payload
  std::uint32_t bit = 0;     ///< of the value in the valid bits
};

}  // namespace chimera
