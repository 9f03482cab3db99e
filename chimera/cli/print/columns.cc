// SPDX-License-Identifier: Apache-2.0
// Measures cells and writes a table.
#include "chimera/cli/print/columns.h"

#include <algorithm>

#include "chimera/base/assert.h"
#include "chimera/base/hosted/wording.h"

namespace chimera::cli {

std::size_t width_of(std::string_view text) {
  return static_cast<std::size_t>(
      std::count_if(text.begin(), text.end(), [](char c) { return (static_cast<unsigned char>(c) & 0xC0) != 0x80; }));
}

std::string fitted(std::string_view text, std::size_t width, bool right) {
  const std::size_t has = width_of(text);
  if (has <= width) {
    const std::string room(width - has, ' ');
    return right ? room + std::string(text) : std::string(text) + room;
  }
  if (width == 0) return "";
  std::size_t end = 0;
  for (std::size_t letters = 0; letters + 1 < width; ++letters)
    do ++end;
    while (end < text.size() && (static_cast<unsigned char>(text[end]) & 0xC0) == 0x80);
  return std::string(text.substr(0, end)) + "~";
}

Columns::Columns(std::vector<std::string> heading) {
  for (std::string& word : heading) {
    is_right_.push_back(!word.empty() && word[0] == '>');
    if (is_right_.back()) word.erase(0, 1);
  }
  rows_.push_back(std::move(heading));
}

void Columns::add(std::vector<std::string> row) {
  CHIMERA_ASSERT(row.size() == is_right_.size());
  rows_.push_back(std::move(row));
}

std::string Columns::text() const {
  std::vector<std::size_t> widths(is_right_.size(), 0);
  for (const auto& row : rows_)
    for (std::size_t i = 0; i < row.size(); ++i) widths[i] = std::max(widths[i], width_of(row[i]));
  std::string all;
  for (const auto& row : rows_) {
    std::string line =
        join_n(row.size(), "  ", [&](std::size_t i) { return fitted(row[i], widths[i], is_right_[i]); });
    line.erase(line.find_last_not_of(' ') + 1);
    all += line + "\n";
  }
  return all;
}

}  // namespace chimera::cli
