// SPDX-License-Identifier: Apache-2.0
// Parses a decimal number into digits and an exponent, without rounding.
#include "chimera/text/decimal.h"

#include <charconv>
#include <cmath>

namespace chimera {
namespace {

__extension__ using Wide = unsigned __int128;

/// The parts of a number, found before anything is converted.
struct Scan {
  std::size_t end = 0;
  std::size_t n_digits = 0;
  Decimal value;
  bool is_exact = true;

  void take(char digit, bool after_point) {
    ++n_digits;
    if (value.digits > (UINT64_MAX - 9) / 10) {
      is_exact = is_exact && digit == '0';
      if (!after_point) ++value.exponent;
      return;
    }
    value.digits = value.digits * 10 + static_cast<std::uint64_t>(digit - '0');
    if (after_point) --value.exponent;
  }
};

/// The exponent that stands at `at`, bounded; 0 bytes long when there is none.
std::size_t exponent_length(std::string_view text, std::size_t at, int& exponent) {
  std::size_t i = at;
  if (i >= text.size() || (text[i] != 'e' && text[i] != 'E')) return 0;
  ++i;
  const bool negative = i < text.size() && text[i] == '-';
  if (i < text.size() && (text[i] == '-' || text[i] == '+')) ++i;
  const std::size_t digits = i;
  int value = 0;
  for (; i < text.size() && is_digit(text[i]); ++i) {
    if (value < 10'000) value = value * 10 + (text[i] - '0');
  }
  if (i == digits) return 0;
  exponent = negative ? -value : value;
  return i - at;
}

Scan scan(std::string_view text) {
  Scan s;
  if (!text.empty() && (text[0] == '-' || text[0] == '+')) {
    s.value.negative = text[0] == '-';
    ++s.end;
  }
  for (; s.end < text.size() && is_digit(text[s.end]); ++s.end) s.take(text[s.end], false);
  if (s.end < text.size() && text[s.end] == '.') {
    ++s.end;
    for (; s.end < text.size() && is_digit(text[s.end]); ++s.end) s.take(text[s.end], true);
  }
  int exponent = 0;
  if (s.n_digits > 0) s.end += exponent_length(text, s.end, exponent);
  s.value.exponent += exponent;
  while (s.value.digits != 0 && s.value.digits % 10 == 0) s.value.digits /= 10, ++s.value.exponent;
  if (s.value.digits == 0) s.value.exponent = 0;
  return s;
}

}  // namespace

std::optional<std::int64_t> Decimal::whole(std::int64_t scale) const noexcept {
  Wide product = static_cast<Wide>(digits) * static_cast<Wide>(scale);
  for (int e = exponent; e < 0 && product != 0; ++e) {
    if (product % 10 != 0) return std::nullopt;
    product /= 10;
  }
  for (int e = exponent; e > 0 && product != 0; --e) {
    if (product > INT64_MAX) return std::nullopt;
    product *= 10;
  }
  if (product > INT64_MAX) return std::nullopt;
  const auto size = static_cast<std::int64_t>(product);
  return negative ? -size : size;
}

std::optional<DecimalText> read_decimal(std::string_view text) {
  const Scan s = scan(text);
  if (s.n_digits == 0) return std::nullopt;
  const std::size_t sign = text[0] == '+' ? 1 : 0;  // from_chars takes no plus
  DecimalText number{.value = s.value, .nearest = 0, .length = s.end, .is_exact = s.is_exact};
  const auto [end, code] = std::from_chars(text.data() + sign, text.data() + s.end, number.nearest);
  if (code == std::errc::result_out_of_range && s.value.exponent < 0)
    number.nearest = 0;  // below the smallest double
  else if (code != std::errc() || end != text.data() + s.end || !std::isfinite(number.nearest))
    return std::nullopt;
  return number;
}

}  // namespace chimera
