// SPDX-License-Identifier: Apache-2.0
// A value that an operator typed, as the bytes of a variable.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string_view>

#include "firmware/shell/text_line.h"

namespace chimera::firmware {

/// Name, unit and shape of a variable.
struct ValueShape {
  std::string_view name;  ///< of the variable
  std::string_view unit;  ///< "1": none
  std::uint32_t type = 0;  ///< CHIMERA_BOOL ... CHIMERA_STRUCT
  std::uint32_t element_bytes = 0;
  std::uint32_t count = 1;  ///< elements
};

/// Longest value that can be typed.
inline constexpr std::size_t kMostValueBytes = 96;

/// Writes shape.count * shape.element_bytes bytes for `words`: one for each element, and maybe the unit. The words of a
/// text are `text` as a whole. False: nothing is to be used, and `why` got the reason. Requires: at most 12 words.
/// Context: any; wait-free; O(bytes), and read_number() for one element of a floating type.
class TypedValue {
 public:
  /// The words outlive this.
  TypedValue(const ValueShape& shape, std::span<const std::string_view> words, std::string_view text,
             std::span<std::byte, kMostValueBytes> to) noexcept
      : shape_(shape), words_(words), text_(text), to_(to) {}

  /// Judges number and unit, before any element is read. Returns false with a reason in `why`.
  bool begin(TextLine& why) noexcept;
  /// Reads the next element. False with a reason in `why`. Requires: begin(), and !is_complete().
  bool read_next(TextLine& why) noexcept;
  bool is_complete() const noexcept { return n_read_ == n_words_; }
  std::span<const std::byte> bytes() const noexcept {
    return std::span<const std::byte>(to_).first(std::size_t{shape_.count} * shape_.element_bytes);
  }

 private:
  bool begin_text(TextLine& why) noexcept;

  ValueShape shape_;
  std::span<const std::string_view> words_;
  std::string_view text_;
  std::span<std::byte, kMostValueBytes> to_;
  std::size_t n_words_ = 0, n_read_ = 0;  // of values, the unit not counted
};

}  // namespace chimera::firmware
