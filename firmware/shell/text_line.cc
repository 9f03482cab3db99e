// SPDX-License-Identifier: Apache-2.0
// Writes numbers and texts into a line.
#include "firmware/shell/text_line.h"

#include <cstdarg>

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

void TextLine::put_all(const char* format, ...) noexcept {
  std::va_list values;
  va_start(values, format);
  for (; *format != '\0'; ++format) {
    if (*format != '%') {
      *this << *format;
      continue;
    }
    switch (*++format) {
      case 's': *this << *va_arg(values, const std::string_view*); break;
      case 'z': *this << std::string_view(va_arg(values, const char*)); break;
      case 'u': put_digits(va_arg(values, unsigned), 1); break;
      case 'd': put_whole(va_arg(values, int)); break;
      case 'l': put_whole(va_arg(values, long long)); break;
      case 'g': *this << number_text(va_arg(values, double)).view(); break;
      case 'm': put_thousandths(va_arg(values, long long), " us"); break;
      default: {
        const std::int64_t time = va_arg(values, long long);
        if (time == kNever.count) *this << std::string_view("never");
        else put_thousandths(time / 1'000'000, " s");
        break;
      }
    }
  }
  va_end(values);
}

void TextLine::put_whole(std::int64_t number) noexcept {
  const auto bits = static_cast<std::uint64_t>(number);
  if (number < 0) *this << '-';
  put_digits(number < 0 ? 0 - bits : bits, 1);  // the most negative number has no positive counterpart
}

// A division of 64 bits is a function on a small machine, one of 32 bits an instruction or a short function.
void TextLine::put_digits(std::uint64_t rest, int least) noexcept {
  char digits[20];
  int n = 0;
  while (rest >> 32 != 0) {
    digits[n++] = static_cast<char>('0' + rest % 10);
    rest /= 10;
  }
  auto low = static_cast<std::uint32_t>(rest);
  for (; low != 0 || n < least; low /= 10) digits[n++] = static_cast<char>('0' + low % 10);
  while (n > 0) *this << digits[--n];
}

void TextLine::put_thousandths(std::int64_t count, const char* unit) noexcept {
  const std::int64_t whole = count / 1000;
  const auto rest = static_cast<std::int32_t>(count - whole * 1000);
  if (count < 0 && whole == 0) *this << '-';
  put_whole(whole);
  *this << '.';
  put_digits(static_cast<std::uint32_t>(rest < 0 ? -rest : rest), 3);
  *this << std::string_view(unit);
}

}  // namespace chimera::firmware
