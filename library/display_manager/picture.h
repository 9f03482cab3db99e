// SPDX-License-Identifier: Apache-2.0
// The picture that a terminal is to show, and the one that it shows. Each call writes a part of the difference, as many
// bytes as the line takes in a cycle, so that a slow line delays nothing.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string_view>

namespace chimera::library {

/// Context of everything: cycle; wait-free; no allocation.
class Picture {
 public:
  static constexpr std::size_t kRows = 8, kColumns = 32;
  /// The longest command: to clear the terminal and to hide its cursor.
  static constexpr std::string_view kClear = "\x1b[2J\x1b[?25l";
  static constexpr std::size_t kLeast = kClear.size();

  /// Fills a row with blanks.
  void blank(std::size_t row) noexcept {
    for (char& cell : wanted_[row]) cell = ' ';
  }
  /// Writes the text from that column on; what does not fit is cut. Bytes that are no character of ASCII become '?'.
  void put(std::size_t row, std::size_t column, std::string_view text) noexcept {
    for (std::size_t i = 0; i < text.size() && column + i < kColumns; ++i)
      wanted_[row][column + i] = text[i] >= ' ' && text[i] <= '~' ? text[i] : '?';
  }
  /// The terminal shows anything: all is to be told again.
  void forget() noexcept { is_clear_ = false; }
  /// Writes at most `to.size()` bytes for the terminal, and returns how many. 0: it shows what it is to show. Requires:
  /// room for kLeast bytes.
  std::size_t tell(std::span<char> to) noexcept {
    std::size_t n = 0;
    if (!is_clear_) n = clear(to);
    for (std::size_t looked = 0; looked < kRows * kColumns; ++looked, at_ = (at_ + 1) % (kRows * kColumns)) {
      char& shown = shown_[at_ / kColumns][at_ % kColumns];
      const char wanted = wanted_[at_ / kColumns][at_ % kColumns];
      if (shown == wanted) continue;
      const bool is_there = cursor_ == at_ && at_ % kColumns != 0;
      if (to.size() - n < (is_there ? 1 : kMove + 1)) return n;
      if (!is_there) n += move(to.subspan(n));
      to[n++] = shown = wanted;
      cursor_ = at_ + 1;
    }
    return n;
  }

 private:
  static constexpr std::size_t kMove = 7;  // ESC [ row ; column H

  std::size_t clear(std::span<char> to) noexcept {
    for (std::size_t i = 0; i < kClear.size(); ++i) to[i] = kClear[i];
    for (auto& row : shown_)
      for (char& cell : row) cell = ' ';
    is_clear_ = true;
    at_ = 0;
    cursor_ = kRows * kColumns;
    return kClear.size();
  }
  std::size_t move(std::span<char> to) const noexcept {
    const std::size_t column = at_ % kColumns + 1;
    std::size_t n = 0;
    to[n++] = '\x1b';
    to[n++] = '[';
    to[n++] = static_cast<char>('1' + at_ / kColumns);
    to[n++] = ';';
    if (column > 9) to[n++] = static_cast<char>('0' + column / 10);
    to[n++] = static_cast<char>('0' + column % 10);
    to[n++] = 'H';
    return n;
  }

  static_assert(kRows <= 9 && kColumns <= 99, "move() writes one digit of the row and two of the column");
  char wanted_[kRows][kColumns] = {}, shown_[kRows][kColumns] = {};
  std::size_t at_ = 0;      // where the comparison goes on
  std::size_t cursor_ = 0;  // of the terminal; behind the last character that was told
  bool is_clear_ = false;
};

}  // namespace chimera::library
