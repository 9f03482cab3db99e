// SPDX-License-Identifier: Apache-2.0
// The constants of a context: written when a producer's init or reinit ends, read by init and reinit alone.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

#include "chimera/base/setup_memory.h"
#include "chimera/runtime/application_spec.h"

namespace chimera {

/// One constant with its present value.
struct Constant {
  const ConstantSpec* spec = nullptr;
  std::span<std::byte> value;  ///< at the size of the largest port that is linked to it
  bool is_known = false;
};

/// By ConstantId of the specs, which outlive it. Context: setup and edge; never cycle.
class ConstantStore {
 public:
  ConstantStore() = default;
  /// Makes room for every constant and sets those that the description gives. Context: setup.
  ConstantStore(const ApplicationSpec& spec, SetupMemory& memory);

  /// Requires: a valid id.
  const Constant& operator[](ConstantId id) const noexcept { return constants_[id.index]; }
  /// Sets the value; true when it differs from the one before or was not known.
  bool set(ConstantId id, std::span<const std::byte> value) noexcept;
  /// The value as a whole number, for extents. `fallback` when it is not known or not a whole number.
  std::int64_t integer(ConstantId id, std::int64_t fallback) const noexcept;

 private:
  std::span<Constant> constants_;
};

}  // namespace chimera
