// SPDX-License-Identifier: Apache-2.0
// Writes numbers and texts into a line.
#include "firmware/shell/text_line.h"

#include "chimera/base/number_text.h"

namespace chimera::firmware {

TextLine& TextLine::operator<<(char c) noexcept {
  if (size_ == kMost) {
    for (std::size_t i = kMost - 3; i < kMost; ++i) bytes_[i] = '.';
    return *this;
  }
  const auto code = static_cast<unsigned char>(c);
  bytes_[size_++] = code < 0x20 || code == 0x7f ? '?' : c;
  return *this;
}

TextLine& TextLine::operator<<(std::string_view text) noexcept {
  for (const char c : text) *this << c;
  return *this;
}

TextLine& TextLine::operator<<(const char* text) noexcept {
  for (; *text != '\0'; ++text) *this << *text;
  return *this;
}

TextLine& TextLine::operator<<(double number) noexcept { return *this << number_text(number).view(); }

TextLine& TextLine::operator<<(Nanoseconds time) noexcept {
  if (time == kNever) return *this << "never";
  return put_thousandths(time.count / 1'000'000) << " s";
}

TextLine& TextLine::put_us(Nanoseconds time) noexcept { return put_thousandths(time.count) << " us"; }

TextLine& TextLine::put_whole(bool is_negative, std::uint64_t bits) noexcept {
  if (is_negative) *this << '-';
  return put_digits(is_negative ? 0 - bits : bits, 1);  // the most negative number has no positive counterpart
}

TextLine& TextLine::put_int(std::int32_t number) noexcept {
  return put_whole(number < 0, static_cast<std::uint64_t>(std::int64_t{number}));
}

TextLine& TextLine::put_uint(std::uint32_t number) noexcept { return put_whole(false, number); }

// A division of 64 bits is a function on a small machine, one of 32 bits an instruction or a short function.
TextLine& TextLine::put_digits(std::uint64_t rest, int least) noexcept {
  char digits[20];
  int n = 0;
  while (rest >> 32 != 0) {
    digits[n++] = static_cast<char>('0' + rest % 10);
    rest /= 10;
  }
  auto low = static_cast<std::uint32_t>(rest);
  for (; low != 0 || n < least; low /= 10) digits[n++] = static_cast<char>('0' + low % 10);
  while (n > 0) *this << digits[--n];
  return *this;
}

TextLine& TextLine::put_thousandths(std::int64_t count) noexcept {
  const auto bits = static_cast<std::uint64_t>(count);
  const std::uint64_t size = count < 0 ? 0 - bits : bits;
  if (count < 0) *this << '-';
  put_digits(size / 1000, 1);
  *this << '.';
  return put_digits(size % 1000, 3);
}

}  // namespace chimera::firmware
