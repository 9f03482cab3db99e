// SPDX-License-Identifier: Apache-2.0
// Tables for people: every column as wide as its widest cell.
#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace chimera::cli {

/// Columns that a UTF-8 text takes on a terminal, for the letters the project prints (one each).
std::size_t width_of(std::string_view text);
/// `text` filled with spaces, or cut with a '~' at its end, to exactly `width` columns.
std::string fitted(std::string_view text, std::size_t width, bool right = false);

/// A heading and rows. A heading that begins with '>' stands right, and its cells too. Context: setup.
class Columns {
 public:
  explicit Columns(std::vector<std::string> heading);
  /// Requires: as many cells as the heading has.
  void add(std::vector<std::string> row);
  bool empty() const noexcept { return rows_.size() == 1; }
  /// One line each, two spaces between columns, none at the end.
  std::string text() const;

 private:
  std::vector<bool> is_right_;
  std::vector<std::vector<std::string>> rows_;
};

}  // namespace chimera::cli
