// SPDX-License-Identifier: Apache-2.0
// Finds the mistake behind a message of the YAML parser: a missing quote, bracket or space, a wrong indent.
#include "chimera/description/yaml_fault.h"

#include <algorithm>
#include <optional>
#include <string>
#include <vector>

#include "chimera/base/hosted/wording.h"
#include "chimera/description/draft_values.h"

namespace chimera {
namespace {

Fault fault(Place at, std::string message, std::string remedy) {
  return {.rule = "yaml-syntax",
          .at = at,
          .message = std::move(message),
          .remedy = std::move(remedy)};
}

char closing(char open) { return open == '{' ? '}' : ']'; }

std::string quoted(char c) { return in_quotes({&c, 1}); }

struct Bracket {
  char open;
  Place at;
};

/// Reads the text and matches its brackets; skips quoted texts and comments.
class Brackets {
 public:
  explicit Brackets(std::string_view text) : text_(text) {}

  /// The fault of a wrong bracket, or nothing.
  std::optional<Fault> find() {
    for (; i_ < text_.size(); step()) {
      const char c = text_[i_];
      if ((c == '"' || c == '\'') && begins_a_value())
        skip_quoted(c);
      else if (c == '#' && (i_ == 0 || text_[i_ - 1] == ' ' || text_[i_ - 1] == '\n'))
        skip_comment();
      else if ((c == '{' || c == '[') && (!open_.empty() || begins_a_value()))
        open_.push_back({c, at_});
      else if ((c == '}' || c == ']') && !open_.empty() && closing(open_.back().open) != c)
        return mismatch(c);
      else if ((c == '}' || c == ']') && !open_.empty())
        open_.pop_back();
      if (i_ < text_.size() && text_[i_] != ' ' && text_[i_] != '\n' && text_[i_] != '\r') last_ = text_[i_];
    }
    if (open_.empty()) return std::nullopt;
    const Bracket& first = open_.front();
    return fault(first.at, "not YAML: nothing closes this " + quoted(first.open),
                 "add the missing " + quoted(closing(first.open)));
  }

 private:
  void step() {
    at_ = text_[i_] == '\n' ? Place{at_.line + 1, 1} : Place{at_.line, at_.column + 1};
    ++i_;
  }
  bool begins_a_value() const { return last_ == '\0' || std::string_view(":,[{-").find(last_) != std::string::npos; }
  void skip_quoted(char quote) {
    for (step(); i_ < text_.size() && text_[i_] != quote; step())
      if (quote == '"' && text_[i_] == '\\' && i_ + 1 < text_.size()) step();
    if (i_ == text_.size()) --i_;
  }
  void skip_comment() {
    while (i_ + 1 < text_.size() && text_[i_ + 1] != '\n') step();
  }
  Fault mismatch(char c) {
    const Bracket& open = open_.back();
    return fault(at_,
                 "not YAML: " + quoted(c) + " stands where the " + quoted(open.open) + " of " +
                     std::to_string(open.at.line) + ':' + std::to_string(open.at.column) + " has to be closed",
                 "add the missing " + quoted(closing(open.open)) + ", or take this one out");
  }

  std::string_view text_;
  std::size_t i_ = 0;
  Place at_{1, 1};
  char last_ = '\0';
  std::vector<Bracket> open_;
};

/// A line and the column of its first word, behind the indentation and the '-' of a list.
struct IndentedLine {
  std::string_view text;
  std::size_t first;
};

std::vector<IndentedLine> lines_to(std::string_view text, std::uint32_t last) {
  std::vector<IndentedLine> lines;
  for (std::size_t start = 0; start < text.size() && lines.size() < last;) {
    const std::size_t end = std::min(text.find('\n', start), text.size());
    const std::string_view line = text.substr(start, end - start);
    lines.push_back({line, std::min(line.find_first_not_of(" -"), line.size())});
    start = end + 1;
  }
  return lines;
}

/// `kp:0.2`: a word and a ':' without its space.
std::optional<Fault> glued_key(const IndentedLine& line, std::uint32_t number) {
  const std::size_t colon = line.text.find(':', line.first);
  if (colon == std::string_view::npos || colon + 1 >= line.text.size()) return std::nullopt;
  const std::string_view key = line.text.substr(line.first, colon - line.first);
  if (!is_name(key) || line.text[colon + 1] == ' ' || line.text[colon + 1] == '\r') return std::nullopt;
  return fault({number, static_cast<std::uint32_t>(line.first + 1)},
               "not YAML: no space after the ':' of '" + std::string(key) + ":'",
               "write '" + std::string(key) + ": " + std::string(line.text.substr(colon + 1, 40)) + "'");
}

/// True for a line that is deeper than the line before, which already has its value.
bool is_deeper_below_a_value(const std::vector<IndentedLine>& lines, std::uint32_t at) {
  if (at < 2 || at > lines.size()) return false;
  const std::string_view before = lines[at - 2].text.substr(0, lines[at - 2].text.find_last_not_of(" \r") + 1);
  return lines[at - 1].first > lines[at - 2].first && !before.empty() && before.back() != ':';
}

}  // namespace

Fault yaml_fault(std::string_view text, Place at, std::string_view reason) {
  const std::vector<IndentedLine> lines = lines_to(text, at.line);
  for (std::size_t i = lines.size(); i > 0; --i)  // the nearest line before the place where the parser stopped
    if (auto glued = glued_key(lines[i - 1], static_cast<std::uint32_t>(i))) return *std::move(glued);
  if (auto bracket = Brackets(text).find()) return *std::move(bracket);
  return fault(
      at, "not YAML: " + std::string(reason),
      is_deeper_below_a_value(lines, at.line)
          ? "begin the keys of one map in the same column; the line above has its value already"
          : "the mistake is here or in the lines above: a missing ':' or quote, or a line that begins in another "
            "column than its neighbours");
}

}  // namespace chimera
