// SPDX-License-Identifier: Apache-2.0
// The lines of a recording, "t(s),q[0](rad)" and then numbers: their fields, and what is wrong with a foreign line.
#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace chimera {

/// The fields between the commas; one field without a comma. Context: setup.
inline std::vector<std::string_view> fields_of(std::string_view line) {
  std::vector<std::string_view> fields;
  for (;;) {
    const std::size_t comma = line.find(',');
    fields.push_back(line.substr(0, comma));
    if (comma == std::string_view::npos) return fields;
    line.remove_prefix(comma + 1);
  }
}

/// A field of the head: "q[0](rad)" has a name and a unit. `unit` is empty if there is none.
struct ColumnHead {
  std::string_view name, unit;
};

/// Context: setup.
inline ColumnHead column_head(std::string_view field) {
  const std::size_t open = field.find('(');
  if (open == std::string_view::npos || !field.ends_with(')')) return {field, {}};
  return {field.substr(0, open), field.substr(open + 1, field.size() - open - 2)};
}

/// The line without its carriage return, and without the byte order mark that some programs write. Context: setup.
inline std::string_view recording_line(std::string_view line) {
  if (line.starts_with("\xEF\xBB\xBF")) line.remove_prefix(3);
  if (line.ends_with('\r')) line.remove_suffix(1);
  return line;
}

/// The reason why no program of ours wrote `line`, with the remedy; empty for a line of the right form. Context: setup.
inline std::string foreign_line(std::string_view line) {
  const std::size_t first = line.find_first_not_of(" \t");
  if (first != std::string_view::npos && (line[first] == '#' || line[first] == '%' || line[first] == '/'))
    return "is a comment: a recording has none, so remove the line";
  if (line.find('"') != std::string_view::npos) return "has quotes: write the fields without them";
  if (line.find(';') != std::string_view::npos)
    return "has ';' between its fields: write ',' there, and a decimal point in numbers";
  if (line.find('\t') != std::string_view::npos) return "has a tab: write ',' between the fields, and no blank";
  if (line.find(' ') != std::string_view::npos) return "has a blank: write no blank beside a comma or in a field";
  return {};
}

/// The reason why `line` is no head of a recording; empty for a head. Context: setup.
inline std::string foreign_head(std::string_view line) {
  if (std::string why = foreign_line(line); !why.empty()) return why;
  const std::string_view time = line.substr(0, line.find(','));
  if (time == "t(s)" || time == "t") return {};
  const bool is_number = !time.empty() && time.find_first_not_of("+-.0123456789eE") == std::string_view::npos;
  if (is_number) return "is a row of numbers: the first line is a head, such as t(s),q[0](rad)";
  return "the first column is '" + std::string(time.substr(0, 40)) + "', expected 't(s)', the time in s";
}

}  // namespace chimera
