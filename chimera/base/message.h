// SPDX-License-Identifier: Apache-2.0
// Builds the text of an error in place, without heap or <cstdio>: Message() << "found " << 3 << ", expected 4".
#pragma once

#include <concepts>
#include <cstddef>
#include <cstdint>
#include <string_view>

#include "chimera/base/result.h"

namespace chimera {

/// At most 400 bytes; a longer text is cut. Context: any; wait-free.
class Message {
 public:
  Message() noexcept = default;
  explicit Message(std::string_view text) noexcept { *this << text; }

  Message& operator<<(std::string_view text) noexcept {
    for (const char c : text)
      if (size_ < sizeof bytes_) bytes_[size_++] = c;
    return *this;
  }
  Message& operator<<(const char* text) noexcept { return *this << std::string_view(text); }
  template <std::integral Number>
    requires(!std::same_as<Number, bool> && !std::same_as<Number, char>)
  Message& operator<<(Number number) noexcept {
    const bool negative = number < 0;
    // Negates as unsigned, because the most negative number has no positive counterpart.
    auto rest = static_cast<std::uint64_t>(number);
    if (negative) rest = 0 - rest;
    char digits[20];
    std::size_t n = 0;
    do digits[n++] = static_cast<char>('0' + rest % 10);
    while ((rest /= 10) != 0);
    if (negative) *this << "-";
    while (n > 0) *this << std::string_view(&digits[--n], 1);
    return *this;
  }

  std::string_view view() const noexcept { return {bytes_, size_}; }
  bool empty() const noexcept { return size_ == 0; }
  /// An error with this text.
  Error error(ErrorCode code, std::string_view where = {}) const noexcept {
    Error e;
    e.code = code;
    e.message.assign(view());
    e.where.assign(where);
    return e;
  }

 private:
  char bytes_[400];
  std::size_t size_ = 0;
};

}  // namespace chimera
