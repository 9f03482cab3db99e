// SPDX-License-Identifier: Apache-2.0
// The constants of a context: written when a producer's init or reinit ends, read by init and reinit alone.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string_view>
#include <vector>

#include "chimera/base/ids.h"
#include "chimera/task/task_spec.h"

namespace chimera {

/// One constant variable with its present value.
struct Constant {
  std::string_view name;
  std::uint32_t type = CHIMERA_FLOAT64;
  std::vector<std::byte> value;  ///< at its maximum size
  bool is_known = false;
  TaskId producer;               ///< invalid: given by the description
};

/// Context: setup and edge; never cycle.
class ConstantStore {
 public:
  /// Makes room for a constant; a second call with the same name keeps the larger size. Returns its index.
  std::size_t declare(std::string_view name, std::uint32_t type, std::size_t bytes);
  /// The constant of that name; nullptr when nobody declared it.
  const Constant* find(std::string_view name) const noexcept;
  /// Sets the value; true when it differs from the one before or was not known.
  bool set(std::string_view name, std::span<const std::byte> value, TaskId producer) noexcept;
  /// The value as a whole number, for extents. `fallback` when it is not known or not a number.
  std::int64_t integer(std::string_view name, std::int64_t fallback) const noexcept;

 private:
  std::vector<Constant> constants_;
};

}  // namespace chimera
