// SPDX-License-Identifier: Apache-2.0
// Values of state variables as people and programs read them, and as numbers to compare.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "chimera/load/descriptor.h"

namespace chimera {

/// The layout of the bytes of a variable.
struct ValueForm {
  std::uint32_t type = CHIMERA_FLOAT64;
  std::uint32_t element_bytes = 8;
  std::uint32_t count = 1;
  bool is_scalar = true;
  std::string unit = "1";
  std::vector<FieldDescriptor> fields;  ///< of a struct
  std::string shown = {};               ///< unit of a text, for floats: value * factor + offset; empty: `unit`
  double factor = 1, offset = 0;
};

/// "27.7778 m/s", "[0.1 0.2] rad", "{x: 1 m, y: 2 m}"; six significant digits.
std::string value_text(const ValueForm& form, std::span<const std::byte> bytes);
/// The value as JSON, numbers exact; NaN and infinity become null.
std::string value_json(const ValueForm& form, std::span<const std::byte> bytes);
/// Every number of the value in order; texts give none.
std::vector<double> numbers(const ValueForm& form, std::span<const std::byte> bytes);

}  // namespace chimera
