// SPDX-License-Identifier: Apache-2.0
// Where the parts of a tree begin and end in the text that it was read from. The reader knows only where they begin.
#pragma once

#include <cstddef>
#include <optional>
#include <string_view>
#include <vector>

#include "chimera/description/node.h"

namespace chimera {

/// Offsets of an entry of a map, or of an item of a list.
struct TextPart {
  std::size_t begin = 0;    ///< of the key; of the item; in a block list, of its dash
  std::size_t key_end = 0;  ///< equal to `begin` in a list
  std::size_t after = 0;    ///< behind the colon or dash; `begin` of an item in brackets
  std::size_t value = 0;    ///< of the value; `after` if there is none
  std::size_t end = 0;      ///< of the value
  bool has_colon = true;    ///< false for `{a, b}`: keys without a colon
};

class TextPlaces {
 public:
  explicit TextPlaces(std::string_view text);

  std::string_view text() const noexcept { return text_; }
  std::size_t offset_of(Place at) const noexcept;
  std::size_t line_begin(std::size_t at) const noexcept;
  /// Offset of the line end ("\n" or "\r\n") at or after `at`; the size of the text if there is none.
  std::size_t line_end(std::size_t at) const noexcept;
  std::size_t next_line(std::size_t at) const noexcept;
  /// Offset of the line end that stands before the line at `begin`.
  std::size_t break_before(std::size_t begin) const noexcept;
  /// True if the line above is blank; comments between do not count.
  bool is_blank_above(std::size_t at) const noexcept;
  bool is_first_on_line(std::size_t at) const noexcept;
  /// True if only blanks and a comment follow on the line.
  bool is_last_on_line(std::size_t at) const noexcept;
  bool is_same_line(std::size_t a, std::size_t b) const noexcept { return line_begin(a) == line_begin(b); }
  /// "\r\n" or "\n", as at the end of this line or of the lines before it.
  std::string_view line_break(std::size_t at) const noexcept;
  /// Behind blanks, line ends and comments.
  std::size_t skip_gap(std::size_t at) const noexcept;
  std::size_t skip_blanks(std::size_t at) const noexcept;
  /// Behind the comma that follows, with a gap before it; nullopt if another character follows.
  std::optional<std::size_t> after_comma(std::size_t at) const noexcept;

  /// True if `value`, a list or map, has brackets.
  bool has_brackets(const Node& value) const noexcept;
  /// The parts of a list or map, in order. nullopt if the text has a form that is not followed here, as `? key`.
  std::optional<std::vector<TextPart>> parts_of(const Node& value) const;

 private:
  /// Behind anchors and tags.
  std::size_t content_of(Place at) const noexcept;
  std::optional<std::size_t> scalar_end(std::size_t at, std::string_view value) const noexcept;
  std::optional<std::size_t> end_of(const Node& value, std::size_t after) const;
  std::optional<TextPart> entry_of(const Node& map, std::size_t i) const;

  std::string_view text_;
  std::vector<std::size_t> lines_;  // where each begins
};

}  // namespace chimera
