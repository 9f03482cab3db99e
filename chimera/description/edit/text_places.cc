// SPDX-License-Identifier: Apache-2.0
// Follows the text beside its tree to find where each value ends.
#include "chimera/description/edit/text_places.h"

#include <algorithm>

namespace chimera {
namespace {

bool is_blank(char c) { return c == ' ' || c == '\t'; }
bool is_gap(char c) { return is_blank(c) || c == '\r' || c == '\n'; }

std::optional<std::size_t> quoted_end(std::string_view text, std::size_t at) {
  const char quote = text[at];
  for (std::size_t i = at + 1; i < text.size(); ++i) {
    const bool is_escape = quote == '"' && text[i] == '\\';
    const bool is_doubled = quote == '\'' && text.substr(i, 2) == "''";
    if (is_escape || is_doubled)
      ++i;
    else if (text[i] == quote)
      return i + 1;
  }
  return std::nullopt;
}

/// A plain text may continue on the next lines: the parser makes one space of a line end, and n - 1 line ends of n.
std::optional<std::size_t> plain_end(std::string_view text, std::size_t at, std::string_view value) {
  std::size_t read = 0;
  while (read < value.size()) {
    if (at >= text.size()) return std::nullopt;
    std::size_t gap_end = at;
    while (gap_end < text.size() && is_gap(text[gap_end])) ++gap_end;
    const std::string_view gap = text.substr(at, gap_end - at);
    const auto breaks = static_cast<std::size_t>(std::count(gap.begin(), gap.end(), '\n'));
    if (breaks == 0) {
      if (text[at++] != value[read++]) return std::nullopt;
      continue;
    }
    const std::size_t folded = std::max<std::size_t>(1, breaks - 1);
    for (std::size_t i = 0; i < folded; ++i, ++read)
      if (read >= value.size() || value[read] != (breaks == 1 ? ' ' : '\n')) return std::nullopt;
    at = gap_end;
  }
  return at;
}

/// Behind the word for nothing (`~`, `null`) or the YAML alias (`*name`) that may stand at `at`.
std::size_t nothing_end(std::string_view text, std::size_t at) {
  if (text.substr(at).starts_with('*')) return std::min(text.find_first_of(" \t\r\n,]}", at), text.size());
  for (const std::string_view word : {"~", "null", "Null", "NULL"}) {
    if (!text.substr(at).starts_with(word)) continue;
    const std::size_t end = at + word.size();
    if (end == text.size() || is_gap(text[end]) || text[end] == ',' || text[end] == ']' || text[end] == '}') return end;
  }
  return at;
}

}  // namespace

TextPlaces::TextPlaces(std::string_view text) : text_(text) {
  lines_.push_back(text.starts_with("\xEF\xBB\xBF") ? 3 : 0);
  for (std::size_t i = 0; i < text.size(); ++i)
    if (text[i] == '\n') lines_.push_back(i + 1);
}

std::size_t TextPlaces::offset_of(Place at) const noexcept {
  if (at.line == 0 || at.line > lines_.size()) return text_.size();
  return std::min(lines_[at.line - 1] + at.column - 1, text_.size());
}

std::size_t TextPlaces::line_begin(std::size_t at) const noexcept {
  const auto next = std::upper_bound(lines_.begin(), lines_.end(), at);
  return next == lines_.begin() ? 0 : *std::prev(next);
}

std::size_t TextPlaces::line_end(std::size_t at) const noexcept {
  const std::size_t end = std::min(text_.find('\n', at), text_.size());
  return end > at && end < text_.size() && text_[end - 1] == '\r' ? end - 1 : end;
}

std::size_t TextPlaces::next_line(std::size_t at) const noexcept {
  const std::size_t end = text_.find('\n', at);
  return end == std::string_view::npos ? text_.size() : end + 1;
}

std::size_t TextPlaces::break_before(std::size_t begin) const noexcept {
  if (begin == 0) return 0;
  return begin >= 2 && text_[begin - 2] == '\r' ? begin - 2 : begin - 1;
}

bool TextPlaces::is_blank_above(std::size_t at) const noexcept {
  std::size_t line = line_begin(at);
  while (line > lines_[0]) {
    line = line_begin(line - 1);
    const std::size_t word = skip_blanks(line);
    if (word >= line_end(line)) return true;
    if (text_[word] != '#') return false;
  }
  return false;
}

bool TextPlaces::is_first_on_line(std::size_t at) const noexcept { return skip_blanks(line_begin(at)) >= at; }

bool TextPlaces::is_last_on_line(std::size_t at) const noexcept {
  const std::size_t next = skip_blanks(at);
  return next >= line_end(at) || (text_[next] == '#' && next > at);
}

std::string_view TextPlaces::line_break(std::size_t at) const noexcept {
  std::size_t end = text_.find('\n', at);
  if (end == std::string_view::npos) end = text_.rfind('\n');
  return end != std::string_view::npos && end > 0 && text_[end - 1] == '\r' ? "\r\n" : "\n";
}

std::size_t TextPlaces::skip_gap(std::size_t at) const noexcept {
  for (; at < text_.size(); ++at) {
    const bool is_comment = text_[at] == '#' && (at == lines_[0] || is_gap(text_[at - 1]));
    if (is_comment)
      at = std::min(text_.find('\n', at), text_.size() - 1);
    else if (!is_gap(text_[at]))
      break;
  }
  return at;
}

std::size_t TextPlaces::skip_blanks(std::size_t at) const noexcept {
  while (at < text_.size() && is_blank(text_[at])) ++at;
  return at;
}

std::optional<std::size_t> TextPlaces::after_comma(std::size_t at) const noexcept {
  const std::size_t comma = skip_gap(at);
  return comma < text_.size() && text_[comma] == ',' ? std::optional(comma + 1) : std::nullopt;
}

std::size_t TextPlaces::content_of(Place place) const noexcept {
  std::size_t at = offset_of(place);
  while (at < text_.size() && (text_[at] == '&' || text_[at] == '!')) {
    while (at < text_.size() && !is_gap(text_[at])) ++at;
    at = skip_gap(at);
  }
  return at;
}

std::optional<std::size_t> TextPlaces::scalar_end(std::size_t at, std::string_view value) const noexcept {
  if (at >= text_.size()) return std::nullopt;
  if (text_[at] == '|' || text_[at] == '>') return line_end(at);  // no edit touches a block scalar
  return text_[at] == '"' || text_[at] == '\'' ? quoted_end(text_, at) : plain_end(text_, at, value);
}

bool TextPlaces::has_brackets(const Node& value) const noexcept {
  const std::size_t at = content_of(value.at);
  return at < text_.size() && text_[at] == (value.is_list() ? '[' : '{');
}

std::optional<std::size_t> TextPlaces::end_of(const Node& value, std::size_t after) const {
  if (value.is_none()) {
    const std::size_t word = skip_blanks(after), end = nothing_end(text_, word);
    return end > word ? end : after;
  }
  const std::size_t at = content_of(value.at);
  if (value.is_scalar()) return scalar_end(at, value.text);
  const bool brackets = has_brackets(value);
  std::size_t end = at + 1;
  if (!value.items.empty()) {
    const Node& last = value.items.back();
    std::optional<std::size_t> last_end;
    if (value.is_map()) {
      const auto entry = entry_of(value, value.items.size() - 1);
      if (entry) last_end = entry->end;
    } else if (!last.is_none()) {
      last_end = end_of(last, 0);
    } else if (const auto parts = parts_of(value)) {
      last_end = parts->back().end;
    }
    if (!last_end) return std::nullopt;
    end = *last_end;
  }
  if (!brackets) return value.items.empty() ? std::nullopt : std::optional(end);
  end = skip_gap(after_comma(end).value_or(end));
  const char closing = value.is_list() ? ']' : '}';
  return end < text_.size() && text_[end] == closing ? std::optional(end + 1) : std::nullopt;
}

std::optional<TextPart> TextPlaces::entry_of(const Node& map, std::size_t i) const {
  TextPart part;
  part.begin = content_of(map.keys[i].at);
  const auto key_end = scalar_end(part.begin, map.keys[i].text);
  if (!key_end) return std::nullopt;
  part.key_end = *key_end;
  const std::size_t colon = skip_blanks(part.key_end);
  part.has_colon = colon < text_.size() && text_[colon] == ':';
  if (!part.has_colon && !(map.items[i].is_none() && has_brackets(map))) return std::nullopt;
  part.after = part.has_colon ? colon + 1 : part.key_end;
  const auto end = end_of(map.items[i], part.after);
  if (!end || *end < part.after) return std::nullopt;
  part.end = *end;
  part.value = map.items[i].is_none() ? part.after : content_of(map.items[i].at);
  return part;
}

std::optional<std::vector<TextPart>> TextPlaces::parts_of(const Node& value) const {
  std::vector<TextPart> parts;
  const bool brackets = has_brackets(value);
  std::size_t at = content_of(value.at);
  for (std::size_t i = 0; i < value.items.size(); ++i) {
    if (value.is_map()) {
      const auto entry = entry_of(value, i);
      if (!entry) return std::nullopt;
      parts.push_back(*entry);
      continue;
    }
    const Node& item = value.items[i];
    TextPart part;
    part.begin = brackets ? content_of(item.at) : skip_gap(at);
    if (part.begin >= text_.size() || (!brackets && text_[part.begin] != '-')) return std::nullopt;
    part.key_end = part.begin;
    part.after = brackets ? part.begin : part.begin + 1;
    part.value = item.is_none() ? part.after : content_of(item.at);
    const auto end = end_of(item, part.after);
    if (!end || *end < part.after) return std::nullopt;
    part.end = at = *end;
    parts.push_back(part);
  }
  return parts;
}

}  // namespace chimera
