// SPDX-License-Identifier: Apache-2.0
// One line of output, built in place: texts, whole numbers, times, numbers.
#pragma once

#include <concepts>
#include <cstddef>
#include <cstdint>
#include <string_view>
#include <type_traits>

#include "chimera/base/time.h"
#include "firmware/shell/row_format.h"

namespace chimera::firmware {

/// At most 159 bytes. A longer line ends with "...". Control bytes become '?', so that a line stays one line.
/// Functions are not inline, because an image has little flash. Context: any; wait-free.
class TextLine {
 public:
  static constexpr std::size_t kMost = 159;

  TextLine& operator<<(std::string_view text) noexcept;
  TextLine& operator<<(char c) noexcept;
  /// Adds the text with the values in its gaps: RowFormat. Numbers as printf("%g"); times as "12.345 s" and
  /// "1.250 us", kNever in seconds as "never".
  template <class... Values>
  void put(RowFormat<std::type_identity_t<Values>...> format, const Values&... values) noexcept {
    put_all(format.text(), passed(values)...);
  }

  std::string_view view() const noexcept { return {bytes_, size_}; }
  std::size_t size() const noexcept { return size_; }
  void clear() noexcept { size_ = 0; }

 private:
  static const std::string_view* passed(const std::string_view& text) noexcept { return &text; }
  static const char* passed(const char* text) noexcept { return text; }
  static double passed(double number) noexcept { return number; }
  static long long passed(Nanoseconds time) noexcept { return time.count; }
  template <std::integral Number>
  static auto passed(Number number) noexcept {
    if constexpr (std::unsigned_integral<Number>) return static_cast<unsigned>(number);
    else if constexpr (sizeof number <= 4) return static_cast<int>(number);
    else return static_cast<long long>(number);
  }

  // One function for all rows: a call passes the values alone. RowFormat has judged their types.
  void put_all(const char* format, ...) noexcept;
  void put_whole(std::int64_t number) noexcept;
  void put_digits(std::uint64_t rest, int least) noexcept;
  void put_thousandths(std::int64_t count, const char* unit) noexcept;

  std::size_t size_ = 0;  // first, because code for near members is small
  char bytes_[kMost];
};

}  // namespace chimera::firmware
