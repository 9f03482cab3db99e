// SPDX-License-Identifier: Apache-2.0
// One line of output, built in place: texts, whole numbers, times, numbers.
#pragma once

#include <concepts>
#include <cstddef>
#include <cstdint>
#include <string_view>

#include "chimera/base/time.h"

namespace chimera::firmware {

/// At most 159 bytes. A longer line ends with "...". Control bytes become '?', so that a line stays one line.
/// Functions are not inline, because an image has little flash. Context: any; wait-free.
class TextLine {
 public:
  static constexpr std::size_t kMost = 159;

  TextLine& operator<<(std::string_view text) noexcept;
  TextLine& operator<<(const char* text) noexcept;
  TextLine& operator<<(char c) noexcept;
  template <std::integral Number>
    requires(!std::same_as<Number, bool> && !std::same_as<Number, char>)
  TextLine& operator<<(Number number) noexcept {
    if constexpr (sizeof number > 4) return put_whole(number < 0, static_cast<std::uint64_t>(number));
    else if constexpr (std::signed_integral<Number>) return put_int(number);
    else return put_uint(number);
  }
  /// Six digits, as printf("%g").
  TextLine& operator<<(double number) noexcept;
  /// "12.345 s"; kNever is "never".
  TextLine& operator<<(Nanoseconds time) noexcept;
  /// "1.250 us"
  TextLine& put_us(Nanoseconds time) noexcept;

  std::string_view view() const noexcept { return {bytes_, size_}; }
  std::size_t size() const noexcept { return size_; }
  void clear() noexcept { size_ = 0; }

 private:
  TextLine& put_whole(bool is_negative, std::uint64_t bits) noexcept;
  TextLine& put_int(std::int32_t number) noexcept;
  TextLine& put_uint(std::uint32_t number) noexcept;
  TextLine& put_digits(std::uint64_t rest, int least) noexcept;
  TextLine& put_thousandths(std::int64_t count) noexcept;

  char bytes_[kMost];
  std::size_t size_ = 0;
};

}  // namespace chimera::firmware
