// SPDX-License-Identifier: Apache-2.0
// The value of a variable before its first publication. Floats are NaN, so that a reader that does not call valid()
// notices; all other types are zero.
#pragma once

#include <cstddef>
#include <cstdint>
#include <cstring>
#include <limits>
#include <span>

namespace chimera {

/// The kind of the elements of a never-written variable. A struct is filled field by field.
enum class NeverWritten : std::uint8_t { kZero, kFloat32, kFloat64 };

/// Fills all of `values`; a remainder smaller than an element becomes zero. Context: setup; wait-free.
inline void fill_never_written(std::span<std::byte> values, NeverWritten kind) noexcept {
  if (values.empty()) return;
  std::memset(values.data(), 0, values.size());
  constexpr float kNan32 = std::numeric_limits<float>::quiet_NaN();
  constexpr double kNan64 = std::numeric_limits<double>::quiet_NaN();
  if (kind == NeverWritten::kFloat32)
    for (std::size_t i = 0; i + sizeof kNan32 <= values.size(); i += sizeof kNan32)
      std::memcpy(&values[i], &kNan32, sizeof kNan32);
  if (kind == NeverWritten::kFloat64)
    for (std::size_t i = 0; i + sizeof kNan64 <= values.size(); i += sizeof kNan64)
      std::memcpy(&values[i], &kNan64, sizeof kNan64);
}

}  // namespace chimera
