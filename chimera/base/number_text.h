// SPDX-License-Identifier: Apache-2.0
// Numbers as text and back, without a C library, so that a host and a microcontroller read and write the same.
#pragma once

#include <cstddef>
#include <string_view>

#include "chimera/base/fixed.h"

namespace chimera {

/// A decimal number at the beginning of a text. Plain value.
struct ReadNumber {
  double value = 0;        ///< the nearest double, ties to even; infinity or 0 where in_range is false
  std::size_t length = 0;  ///< in bytes; 0: the text does not begin with a number
  bool in_range = true;    ///< false: above the largest double, or not 0 but nearest to 0
};

/// Reads [-]digits[.digits][e[+-]digits], digits on at least one side of the point, as std::from_chars does. Words such
/// as "inf" and "nan" are no numbers. Context: any; no allocation; O(length), at most 800 digits count.
ReadNumber read_number(std::string_view text) noexcept;

/// `value` as printf("%.*g", digits, value) writes it in the C locale; every NaN is "nan". Requires: 1 <= digits <= 17.
/// Context: any; no allocation.
FixedString<24> number_text(double value, int digits = 6) noexcept;

}  // namespace chimera
