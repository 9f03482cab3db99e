// SPDX-License-Identifier: Apache-2.0
// Words of messages and reports: lists, quotes, counts, numbers with their unit of measure.
#pragma once

#include <cstdint>
#include <cstdio>
#include <functional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace chimera {

/// Adds `item` to the list in `text`, behind `separator` unless the list is empty. Context: setup; may block.
inline void append_joined(std::string& text, std::string_view separator, std::string_view item) {
  if (!text.empty()) text += separator;
  text += item;
}

/// The texts of all items with `separator` between them; text_of(item) is the text of an item. `last`, unless it is
/// empty, replaces the last separator. Context: setup; may block.
template <class Items, class TextOf = std::identity>
std::string join(const Items& items, std::string_view separator, TextOf text_of = {}, std::string_view last = {}) {
  std::string all;
  std::size_t gap = std::string::npos;
  bool is_first = true;
  for (const auto& item : items) {
    if (!std::exchange(is_first, false)) {
      gap = all.size();
      all += separator;
    }
    all += std::invoke(text_of, item);
  }
  if (!last.empty() && gap != std::string::npos) all.replace(gap, separator.size(), last);
  return all;
}

/// The texts of the indices 0 to n - 1 with `separator` between them. Context: setup; may block.
template <class TextOf>
std::string join_n(std::size_t n, std::string_view separator, TextOf text_of) {
  std::string all;
  for (std::size_t i = 0; i < n; ++i) {
    if (i > 0) all += separator;
    all += text_of(i);
  }
  return all;
}

/// The names of all items: names_of(tasks, &TaskSpec::name). Context: setup; may block.
template <class Items, class NameOf>
std::vector<std::string> names_of(const Items& items, NameOf name_of) {
  std::vector<std::string> names;
  for (const auto& item : items) names.emplace_back(std::invoke(name_of, item));
  return names;
}

/// 'text'. Context: setup; may block.
inline std::string in_quotes(std::string_view text) { return "'" + std::string(text) + "'"; }
/// "text", unchanged. Context: setup; may block.
inline std::string in_double_quotes(std::string_view text) { return "\"" + std::string(text) + "\""; }
/// "text" as JSON and Graphviz read it: a backslash before each " and \, \n for an end of line, a space for each other
/// control character. Context: setup; may block.
inline std::string backslashed(std::string_view text) {
  std::string all;
  for (const char c : text) {
    if (c == '"' || c == '\\' || c == '\n') all += '\\';
    all += c == '\n' ? 'n' : static_cast<unsigned char>(c) < 0x20 ? ' ' : c;
  }
  return in_double_quotes(all);
}

/// `word` for a shell: in quotes if the shell would cut or change it. Context: setup; may block.
inline std::string shell_word(const std::string& word) {
  constexpr const char* kPlain = "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789_./:=+,@%-";
  if (!word.empty() && word.find_first_not_of(kPlain) == std::string::npos) return word;
  std::string text;
  for (const char c : word) text += c == '\'' ? std::string("'\\''") : std::string(1, c);
  return in_quotes(text);
}

/// "1 row", "2 rows". `many` is the plural; if it is empty, `one` with an s. Context: setup; may block.
inline std::string counted(std::uint64_t n, const std::string& one, const std::string& many = {}) {
  return std::to_string(n) + " " + (n == 1 ? one : many.empty() ? one + "s" : many);
}

/// `value` in a printf `pattern` with one place for a double: "%.3g Hz". Context: setup; may block.
inline std::string formatted(const char* pattern, double value) {
  char text[64];
  std::snprintf(text, sizeof text, pattern, value);
  return text;
}

/// "5 m/s"; a number with the unit of measure "1" stands alone. Context: setup; may block.
inline std::string with_unit(const std::string& number, const std::string& unit) {
  return unit == "1" ? number : number + (" " + unit);
}

}  // namespace chimera
