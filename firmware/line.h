// SPDX-License-Identifier: Apache-2.0
// A line of text for the serial port.
#pragma once

#include <concepts>
#include <cstdint>
#include <string_view>

#include "firmware/boards/board.h"

namespace chimera::firmware {

/// At most 119 bytes and the end of the line; the rest is cut. Context: any; wait-free.
class Line {
 public:
  Line& operator<<(std::string_view text) noexcept {
    for (const char c : text)
      if (size_ < sizeof text_ - 1) text_[size_++] = c;
    return *this;
  }
  Line& operator<<(const char* text) noexcept { return *this << std::string_view(text); }
  template <std::unsigned_integral Number>
  Line& operator<<(Number number) noexcept {
    char digits[20];
    std::size_t n = sizeof digits;
    do digits[--n] = static_cast<char>('0' + number % 10);
    while ((number /= 10) != 0);
    return *this << std::string_view(digits + n, sizeof digits - n);
  }
  /// All 16 digits of `bits` in base 16.
  Line& hex(std::uint64_t bits) noexcept {
    for (int shift = 60; shift >= 0; shift -= 4)
      *this << std::string_view(&"0123456789abcdef"[(bits >> shift) & 15], 1);
    return *this;
  }
  /// The text with the end of the line.
  std::string_view finish() noexcept {
    text_[size_] = '\n';
    return {text_, size_ + 1};
  }

 private:
  char text_[120];
  std::size_t size_ = 0;
};

/// Sends the line, or counts it as lost: BareUart::send. Context: cycle; wait-free.
inline void send(Line& line) noexcept { uart().send(line.finish()); }

}  // namespace chimera::firmware
