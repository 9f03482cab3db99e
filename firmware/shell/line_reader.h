// SPDX-License-Identifier: Apache-2.0
// Collects bytes to lines. CR, LF or both end a line.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string_view>

namespace chimera::firmware {

/// Stands in the input where bytes before it did not fit. As a byte from outside it makes a line bad all the same.
inline constexpr std::uint8_t kLostMark = 0;

/// Context of everything: any; wait-free.
class LineReader {
 public:
  static constexpr std::size_t kMost = 96;  ///< bytes of a line, its end not counted

  /// Why a line is not to be carried out.
  enum class Fault : std::uint8_t {
    kNone,
    kTooLong,  ///< length() is above kMost
    kBadByte,  ///< a byte that is no printable character of ASCII, nor a tab: bad_byte()
    kLost,     ///< kLostMark is in it
  };

  /// True if the byte ends a line; call restart() after use. Empty lines are passed over.
  bool add(std::uint8_t byte) noexcept;
  /// Begins the next line.
  void restart() noexcept { length_ = 0, fault_ = Fault::kNone, bad_byte_ = 0; }

  /// Requires: fault() is kNone.
  std::string_view line() const noexcept { return {bytes_, length_}; }
  Fault fault() const noexcept { return fault_; }
  /// Bytes of the line, those beyond kMost included.
  std::size_t length() const noexcept { return length_; }
  std::uint8_t bad_byte() const noexcept { return bad_byte_; }

 private:
  std::size_t length_ = 0;
  Fault fault_ = Fault::kNone;
  std::uint8_t bad_byte_ = 0;
  char bytes_[kMost];
};

}  // namespace chimera::firmware
