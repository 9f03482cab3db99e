// SPDX-License-Identifier: Apache-2.0
// A number as it was written, without rounding: digits and a power of ten.
#pragma once

#include <cstdint>
#include <optional>
#include <string_view>

namespace chimera {

/// (negative ? -1 : 1) * digits * 10^exponent, with no zero at the end of the digits.
struct Decimal {
  bool negative = false;
  std::uint64_t digits = 0;
  int exponent = 0;

  /// This number times `scale` as a whole number; nullopt when it is none or above INT64_MAX in size.
  std::optional<std::int64_t> whole(std::int64_t scale) const noexcept;
};

constexpr bool is_digit(char c) noexcept { return c >= '0' && c <= '9'; }

/// A decimal number at the beginning of a text: its exact form and its length in bytes.
struct DecimalText {
  Decimal value;
  double nearest = 0;  ///< the double nearest to it
  std::size_t length = 0;
  bool is_exact = true;  ///< false: more digits than `value` can hold (about 19)
};

/// Reads [+-]digits[.digits][e[+-]digits]; digits on at least one side of the point. An `e` counts as an exponent only
/// before a digit or sign. nullopt when the text does not begin so, or the number is no finite double. Context: setup.
std::optional<DecimalText> read_decimal(std::string_view text);

}  // namespace chimera
