// SPDX-License-Identifier: Apache-2.0
// Converts between doubles and decimal texts exactly, by long division of whole numbers.
#include "chimera/base/number_text.h"

#include <algorithm>
#include <bit>
#include <cstdint>

#include "chimera/base/math.h"

namespace chimera {
namespace {

/// A whole number from 0 to 2^2688 - 1. The middle between two doubles has at most 767 digits, so that 2552 bits decide
/// every rounding.
class WholeNumber {
 public:
  WholeNumber() noexcept = default;
  explicit WholeNumber(std::uint64_t value) noexcept {
    for (; value != 0; value >>= 32) words_[size_++] = static_cast<std::uint32_t>(value);
  }

  bool is_zero() const noexcept { return size_ == 0; }
  int bits() const noexcept {
    return size_ == 0 ? 0 : 32 * size_ - std::countl_zero(words_[size_ - 1]);
  }
  void multiply(std::uint32_t factor, std::uint32_t addend = 0) noexcept {
    std::uint64_t carry = addend;
    for (int i = 0; i < size_; ++i, carry >>= 32) {
      carry += std::uint64_t{words_[i]} * factor;
      words_[i] = static_cast<std::uint32_t>(carry);
    }
    if (carry != 0) words_[size_++] = static_cast<std::uint32_t>(carry);
  }
  void multiply_by_power_of_five(int power) noexcept {
    for (; power >= 13; power -= 13) multiply(1'220'703'125);  // 5^13
    for (; power > 0; --power) multiply(5);
  }
  void shift_left(int bits) noexcept {
    if (size_ == 0) return;
    for (; bits >= 32; bits -= 32) {
      std::copy_backward(words_, words_ + size_, words_ + size_ + 1);
      words_[0] = 0;
      ++size_;
    }
    if (bits > 0) multiply(std::uint32_t{1} << bits);
  }
  bool is_below(const WholeNumber& other) const noexcept {
    if (size_ != other.size_) return size_ < other.size_;
    for (int i = size_ - 1; i >= 0; --i)
      if (words_[i] != other.words_[i]) return words_[i] < other.words_[i];
    return false;
  }
  /// Subtracts `other` if that leaves no negative number. Returns true if it did.
  bool try_subtract(const WholeNumber& other) noexcept {
    if (is_below(other)) return false;
    std::uint64_t borrow = 0;
    for (int i = 0; i < size_; ++i) {
      const std::uint64_t less = (i < other.size_ ? other.words_[i] : 0) + borrow;
      borrow = words_[i] < less ? 1 : 0;
      words_[i] = static_cast<std::uint32_t>(words_[i] - less);
    }
    while (size_ > 0 && words_[size_ - 1] == 0) --size_;
    return true;
  }

 private:
  static constexpr int kWords = 84;
  std::uint32_t words_[kWords] = {};  // the lowest first
  int size_ = 0;                 // without zeros above
};

constexpr int kMostDigits = 768;
constexpr std::uint64_t kHidden = std::uint64_t{1} << 52;

/// The digits of a number: whole * 10^exponent, and more behind it if `has_rest`.
struct Digits {
  WholeNumber whole;
  int kept = 0;
  bool has_rest = false;
  std::int64_t exponent = 0;

  void take(char digit, bool is_behind_point) noexcept {
    if (kept == 0 && digit == '0') {
      exponent -= is_behind_point ? 1 : 0;
    } else if (kept < kMostDigits) {
      whole.multiply(10, static_cast<std::uint32_t>(digit - '0'));
      ++kept;
      exponent -= is_behind_point ? 1 : 0;
    } else {
      has_rest = has_rest || digit != '0';
      exponent += is_behind_point ? 0 : 1;
    }
  }
};

bool is_digit_at(std::string_view text, std::size_t at) noexcept {
  return at < text.size() && text[at] >= '0' && text[at] <= '9';
}

/// Reads e[+-]digits at `at`, if it is there, and returns its end.
std::size_t read_exponent(std::string_view text, std::size_t at, std::int64_t& exponent) noexcept {
  if (at >= text.size() || (text[at] != 'e' && text[at] != 'E')) return at;
  std::size_t i = at + 1;
  const bool is_negative = i < text.size() && text[i] == '-';
  if (i < text.size() && (text[i] == '-' || text[i] == '+')) ++i;
  if (!is_digit_at(text, i)) return at;
  std::int64_t value = 0;
  for (; is_digit_at(text, i); ++i)
    if (value < INT64_C(1'000'000'000'000)) value = value * 10 + (text[i] - '0');
  exponent += is_negative ? -value : value;
  return i;
}

/// The double nearest to the digits.
double nearest(const Digits& digits) noexcept {
  const std::int64_t magnitude = digits.kept + digits.exponent;  // below 10^magnitude
  if (digits.kept == 0 || magnitude < -330) return 0;
  if (magnitude > 310) return std::bit_cast<double>(math::kInfinityBits);
  WholeNumber top = digits.whole, bottom(1);  // the number is top / bottom * 2^exponent
  int exponent = static_cast<int>(digits.exponent);
  (exponent < 0 ? bottom : top).multiply_by_power_of_five(exponent < 0 ? -exponent : exponent);
  const int longer = top.bits() - bottom.bits();
  (longer > 0 ? bottom : top).shift_left(longer > 0 ? longer : -longer);
  std::uint64_t quotient = 0;  // top / bottom * 2^63, cut: from 2^62 on
  for (int bit = 0; bit < 64; ++bit) {
    quotient = quotient << 1 | (top.try_subtract(bottom) ? 1 : 0);
    top.shift_left(1);
  }
  const int last = exponent + longer - 63;  // exponent of the last bit of the quotient
  const int cut = std::max(11 - std::countl_zero(quotient), -1074 - last);
  if (cut > 64) return 0;
  std::uint64_t mantissa = cut < 64 ? quotient >> cut : 0;
  const std::uint64_t rest = cut < 64 ? quotient - (mantissa << cut) : quotient;
  const std::uint64_t half = std::uint64_t{1} << (cut - 1);
  const bool is_above_half = rest > half || (rest == half && (!top.is_zero() || digits.has_rest));
  if (is_above_half || (rest == half && (mantissa & 1) != 0)) ++mantissa;
  const std::uint64_t bits = (static_cast<std::uint64_t>(last + cut + 1074) << 52) + mantissa;
  return std::bit_cast<double>(std::min(bits, math::kInfinityBits));
}

/// The first `n` digits of a positive number, rounded, and the power of ten of the first.
struct Rounded {
  char digits[17];
  int exponent = 0;
};

Rounded rounded(double value, int n) noexcept {
  const auto bits = std::bit_cast<std::uint64_t>(value);
  const auto biased = static_cast<int>(bits >> 52);
  const std::uint64_t mantissa = (bits & (kHidden - 1)) | (biased == 0 ? 0 : kHidden);
  const int exponent = (biased == 0 ? 1 : biased) - 1075;
  Rounded found;
  found.exponent = (exponent + 63 - std::countl_zero(mantissa)) * 1233 >> 12;  // log10(2) = 1233 / 4096, nearly
  WholeNumber top(mantissa), bottom(1);  // value = top / bottom * 10^found.exponent
  (exponent < 0 ? bottom : top).shift_left(exponent < 0 ? -exponent : exponent);
  for (int e = found.exponent; e > 0; --e) bottom.multiply(10);
  for (int e = found.exponent; e < 0; ++e) top.multiply(10);
  for (; top.is_below(bottom); --found.exponent) top.multiply(10);
  for (WholeNumber ten = bottom;; ++found.exponent) {
    ten.multiply(10);
    if (top.is_below(ten)) break;
    bottom = ten;
  }
  for (int i = 0; i < n; ++i) {
    if (i > 0) top.multiply(10);
    found.digits[i] = '0';
    while (top.try_subtract(bottom)) ++found.digits[i];
  }
  top.shift_left(1);
  const bool is_half = !top.is_below(bottom) && !bottom.is_below(top);
  if (top.is_below(bottom) || (is_half && (found.digits[n - 1] - '0') % 2 == 0)) return found;
  int i = n - 1;
  for (; i >= 0 && found.digits[i] == '9'; --i) found.digits[i] = '0';
  if (i >= 0) return ++found.digits[i], found;
  found.digits[0] = '1';
  ++found.exponent;
  return found;
}

}  // namespace

ReadNumber read_number(std::string_view text) noexcept {
  const bool is_negative = text.starts_with('-');
  std::size_t at = is_negative ? 1 : 0;
  bool has_digits = false, has_point = false;
  Digits digits;
  for (; is_digit_at(text, at) || (at < text.size() && text[at] == '.' && !has_point); ++at) {
    if (text[at] == '.') has_point = true;
    else has_digits = true, digits.take(text[at], has_point);
  }
  if (!has_digits) return {};
  ReadNumber read;
  read.length = read_exponent(text, at, digits.exponent);
  const double size = nearest(digits);
  read.value = is_negative ? -size : size;
  read.in_range = math::is_finite(size) && (size != 0 || digits.kept == 0);
  return read;
}

FixedString<24> number_text(double value, int digits) noexcept {
  if (math::is_nan(value)) return {"nan"};
  char text[32];
  char* at = text;
  const auto put = [&at](char c, int times = 1) {
    for (; times > 0; --times) *at++ = c;
  };
  if ((std::bit_cast<std::uint64_t>(value) & math::kSignBit) != 0) put('-');
  const double size = math::fabs(value);
  if (!math::is_finite(value)) {
    for (const char c : {'i', 'n', 'f'}) put(c);
  } else if (size == 0) {
    put('0');
  } else {
    const Rounded found = rounded(size, digits);
    int n = digits;  // without zeros at the end
    while (n > 1 && found.digits[n - 1] == '0') --n;
    const bool is_plain = found.exponent >= -4 && found.exponent < digits;
    const int before = is_plain ? found.exponent + 1 : 1;  // digits before the point
    if (before <= 0) put('0'), put('.'), put('0', -before);
    for (int i = 0; i < std::max(n, before); ++i) {
      if (i == before && before > 0) put('.');
      put(i < n ? found.digits[i] : '0');
    }
    if (!is_plain) {
      const int power = found.exponent < 0 ? -found.exponent : found.exponent;
      put('e'), put(found.exponent < 0 ? '-' : '+');
      if (power >= 100) put(static_cast<char>('0' + power / 100));
      put(static_cast<char>('0' + power / 10 % 10)), put(static_cast<char>('0' + power % 10));
    }
  }
  return {std::string_view(text, static_cast<std::size_t>(at - text))};
}

}  // namespace chimera
