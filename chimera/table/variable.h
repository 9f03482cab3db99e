// SPDX-License-Identifier: Apache-2.0
// The data that the table needs about a state variable: its largest size in bytes. verify/ settles names, units and
// shapes; the table never reads a file.
#pragma once

#include <cstdint>
#include <span>
#include <string_view>

#include "chimera/base/ids.h"

namespace chimera {

/// A state variable of a group. Its values take element_bytes * max_count bytes.
struct VariableSpec {
  std::string_view name;
  std::uint32_t element_bytes = 8;
  std::uint32_t max_count = 1;

  std::uint32_t bytes() const noexcept { return element_bytes * max_count; }
};

/// All variables that one task publishes together. At most 64 (one bit each in chimera_slot::valid).
struct GroupSpec {
  std::string_view owner;
  std::span<const VariableSpec> variables;
};

}  // namespace chimera
