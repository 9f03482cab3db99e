// SPDX-License-Identifier: Apache-2.0
// Reads the tags of an XML text one by one, to check attributes before a parser with less precise errors.
#pragma once

#include <algorithm>
#include <cstddef>
#include <iterator>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace chimera::library {

/// A tag. The views refer to the text; values are unchanged, with entities.
struct XmlTag {
  std::string_view element;
  std::vector<std::pair<std::string_view, std::string_view>> attributes;
  std::size_t line = 1;
  std::size_t begin = 0, end = 0;  ///< position of the tag in the text
  bool is_end = false;             ///< </element>
  bool is_empty = false;           ///< <element/>
};

/// Reads the tags of a text. Skips comments, declarations and CDATA sections. Ends at a syntax error, which the parser
/// reports. Context: setup.
class XmlTags {
 public:
  explicit XmlTags(std::string_view text) : text_(text), rest_(text) {}

  /// Reads the next start tag. Returns false at the end.
  bool next(XmlTag& tag) {
    while (next_of_all(tag))
      if (!tag.is_end) return true;
    return false;
  }
  /// Reads the next start or end tag. Returns false at the end.
  bool next_of_all(XmlTag& tag) {
    while (skip_past("<")) {
      tag.begin = at() - 1;
      const std::string_view end = rest_.starts_with("!--")        ? "-->"
                                   : rest_.starts_with("![CDATA[") ? "]]>"
                                   : rest_.starts_with("!")        ? ">"
                                   : rest_.starts_with("?")        ? "?>"
                                                                   : "";
      if (end.empty()) return is_sound_ = rest_.starts_with("/") ? read_end(tag) : read(tag);
      if (!(is_sound_ = skip_past(end))) return false;
    }
    return false;
  }
  /// False if the text ended at a syntax error, in line().
  bool is_sound() const noexcept { return is_sound_; }
  std::size_t line() const noexcept { return line_; }

 private:
  static constexpr std::string_view kSpace = " \t\r\n";

  std::size_t at() const { return text_.size() - rest_.size(); }
  void drop(std::size_t count) {
    for (std::size_t i = 0; i < count; ++i) line_ += rest_[i] == '\n' ? 1 : 0;
    rest_.remove_prefix(count);
  }
  bool skip_past(std::string_view mark) {
    const std::size_t at = rest_.find(mark);
    drop(at == std::string_view::npos ? rest_.size() : at + mark.size());
    return at != std::string_view::npos;
  }
  void skip_space() {
    const std::size_t at = rest_.find_first_not_of(kSpace);
    drop(at == std::string_view::npos ? rest_.size() : at);
  }
  std::string_view take(std::string_view until) {
    const std::string_view taken = rest_.substr(0, rest_.find_first_of(until));
    drop(taken.size());
    return taken;
  }
  bool read_end(XmlTag& tag) {
    drop(1);
    tag.line = line_;
    tag.element = take(" \t\r\n>");
    tag.attributes.clear();
    tag.is_end = true;
    const bool is_closed = skip_past(">");
    tag.end = at();
    return is_closed;
  }
  bool read(XmlTag& tag) {
    tag.is_end = false;
    tag.line = line_;
    tag.element = take(" \t\r\n/>");
    tag.attributes.clear();
    for (skip_space(); !rest_.empty() && rest_.front() != '>' && rest_.front() != '/'; skip_space()) {
      const std::string_view name = take(" \t\r\n=/>");
      skip_space();
      if (rest_.empty() || rest_.front() != '=') return false;
      drop(1);
      skip_space();
      if (rest_.empty() || (rest_.front() != '"' && rest_.front() != '\'')) return false;
      const char quote[] = {rest_.front(), '\0'};
      drop(1);
      tag.attributes.emplace_back(name, take(quote));
      if (rest_.empty()) return false;
      drop(1);
    }
    tag.is_empty = rest_.starts_with('/');
    const bool is_closed = rest_.starts_with(tag.is_empty ? "/>" : ">");
    tag.end = at() + (tag.is_empty ? 2 : 1);
    return is_closed && !tag.element.empty();
  }

  std::string_view text_, rest_;
  std::size_t line_ = 1;
  bool is_sound_ = true;
};

/// The value of an attribute as it is written; a view without data if the tag has none of that name.
inline std::string_view value_of(const XmlTag& tag, std::string_view attribute) {
  for (const auto& [name, value] : tag.attributes)
    if (name == attribute) return value;
  return {};
}

/// `value` with the five predefined entities replaced.
inline std::string plain(std::string_view value) {
  constexpr std::pair<std::string_view, char> kEntities[] = {
      {"&amp;", '&'}, {"&lt;", '<'}, {"&gt;", '>'}, {"&quot;", '"'}, {"&apos;", '\''}};
  std::string text;
  while (!value.empty()) {
    const auto* entity = std::ranges::find_if(kEntities, [&](const auto& e) { return value.starts_with(e.first); });
    const bool is_entity = entity != std::end(kEntities);
    text += is_entity ? entity->second : value.front();
    value.remove_prefix(is_entity ? entity->first.size() : 1);
  }
  return text;
}

}  // namespace chimera::library
