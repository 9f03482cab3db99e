// SPDX-License-Identifier: Apache-2.0
// Numbers in a frame: one after the other, low byte first.
#pragma once

#include <bit>
#include <cstddef>
#include <cstdint>

#include "chimera/base/math.h"

namespace chimera::library {

enum class Form { kFloat32, kInt16 };

/// Bytes of one number. Context: any; wait-free.
constexpr std::size_t width(Form form) noexcept { return form == Form::kFloat32 ? 4 : 2; }

/// Context: cycle; wait-free.
inline void put_bytes(std::uint8_t* to, std::uint32_t bits, std::size_t count) noexcept {
  for (std::size_t i = 0; i < count; ++i) to[i] = static_cast<std::uint8_t>(bits >> (8 * i));
}
inline std::uint32_t get_bytes(const std::uint8_t* from, std::size_t count) noexcept {
  std::uint32_t bits = 0;
  for (std::size_t i = 0; i < count; ++i) bits |= static_cast<std::uint32_t>(from[i]) << (8 * i);
  return bits;
}

/// Rounds to the nearest int16 and cuts at its limits. `x` is finite. Context: cycle; wait-free.
inline std::int16_t whole(double x) noexcept {
  if (x >= 32767) return 32767;
  if (x <= -32768) return -32768;
  return static_cast<std::int16_t>(math::floor(x + 0.5));
}

/// value = number in the frame times resolution. `value` is finite and, as float32, below 1e38.
/// Context: cycle; wait-free.
inline void put_value(std::uint8_t* to, Form form, double value, double resolution) noexcept {
  const double number = value / resolution;
  if (form == Form::kFloat32) put_bytes(to, std::bit_cast<std::uint32_t>(static_cast<float>(number)), 4);
  else put_bytes(to, static_cast<std::uint16_t>(whole(number)), 2);
}
inline double get_value(const std::uint8_t* from, Form form, double resolution) noexcept {
  if (form == Form::kFloat32) return static_cast<double>(std::bit_cast<float>(get_bytes(from, 4))) * resolution;
  return static_cast<double>(static_cast<std::int16_t>(get_bytes(from, 2))) * resolution;
}

}  // namespace chimera::library
