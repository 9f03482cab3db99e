// SPDX-License-Identifier: Apache-2.0
// Reads names, texts, whole numbers, times and values, with a fault for each kind of mistake.
#include "chimera/description/draft_values.h"

#include <algorithm>
#include <charconv>
#include <vector>

#include "chimera/base/hosted/wording.h"
#include "chimera/text/decimal.h"
#include "chimera/text/nearest.h"

namespace chimera {
namespace {

constexpr std::size_t kMaxNameBytes = 64;

bool is_letter(char c) noexcept { return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || c == '_'; }

void add(Report& report, std::string_view rule, const Node& node, std::string message, std::string expected,
         std::string near = {}, std::string remedy = {}) {
  report.add({.rule = rule,
              .at = node.at,
              .message = std::move(message),
              .found = node.text,
              .expected = std::move(expected),
              .nearest = std::move(near),
              .remedy = std::move(remedy)});
}

/// A whole decimal number without sign; nullopt for any other text and for a number above 2^64 - 1.
std::optional<std::uint64_t> whole(std::string_view text) {
  std::uint64_t value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (text.empty() || error != std::errc{} || end != text.data() + text.size()) return std::nullopt;
  return value;
}

template <class Names>
std::string list(const Names& names) {
  return names.empty() ? "none" : join(names, ", ", in_quotes);
}

/// Accepts a scalar without quotes, for numbers.
bool expect_plain(const Node& node, const char* expected, const std::string& what, Report& report) {
  if (node.is_scalar() && !node.quoted) return true;
  add(report, "value-kind", node, what + " is " + written(node) + "; expected " + expected, expected, {},
      node.quoted ? "take the quotes off" : "");
  return false;
}

}  // namespace

bool is_name(std::string_view text) noexcept {
  if (text.empty() || text.size() > kMaxNameBytes || !is_letter(text[0])) return false;
  for (const char c : text)
    if (!is_letter(c) && !is_digit(c)) return false;
  return true;
}

std::string written(const Node& node) {
  constexpr std::size_t kShown = 60;
  switch (node.kind) {
    case Node::Kind::kNone:
      return "nothing";
    case Node::Kind::kList:
      return "a list";
    case Node::Kind::kMap:
      return "a map";
    case Node::Kind::kScalar:
      break;
  }
  const std::string quote = node.quoted ? "\"" : "'";
  return quote + (node.text.size() > kShown ? node.text.substr(0, kShown) + "..." : node.text) + quote;
}

bool check_name(const Word& word, const std::string& what, Report& report) {
  if (is_name(word.text)) return true;
  const std::string shown = word.text.size() > kMaxNameBytes ? word.text.substr(0, kMaxNameBytes) + "..." : word.text;
  const bool glued = word.text.find(':') != std::string::npos;
  report.add({.rule = "name-illegal",
              .at = word.at,
              .message = what + " is '" + shown +
                         "'; expected a letter or '_', then letters, digits and '_', at most " +
                         std::to_string(kMaxNameBytes),
              .found = shown,
              .expected = "a name",
              .remedy = glued ? "a space must follow the ':'" : ""});
  return false;
}

std::optional<Word> read_text(const Node& node, const std::string& what, Report& report) {
  if (node.is_scalar()) return Word{node.text, node.at};
  add(report, "value-kind", node, what + " is " + written(node) + "; expected a text", "a text");
  return std::nullopt;
}

std::optional<Word> read_name(const Node& node, const std::string& what, Report& report) {
  if (!node.is_scalar()) {
    add(report, "value-kind", node, what + " is " + written(node) + "; expected a name", "a name");
    return std::nullopt;
  }
  Word word{node.text, node.at};
  if (!check_name(word, what, report)) return std::nullopt;
  return word;
}

std::optional<Located<Rate>> read_rate(const Node& node, const std::string& what, Report& report) {
  if (!expect_plain(node, "a frequency, as 100 Hz", what, report)) return std::nullopt;
  const Result<Rate> rate = parse_rate(node.text);
  if (rate) return Located<Rate>{*rate, node.at};
  const bool is_form = rate.error().code == ErrorCode::kBadInput;
  add(report, "quantity-bad", node, what + ": " + std::string(rate.error().message.view()), "a frequency", {},
      is_form ? "write a number and Hz, with at most one space between: 100 Hz"
              : "write a rate from 1 MHz down to one per hour");
  return std::nullopt;
}

std::optional<Located<Nanoseconds>> read_duration(const Node& node, const std::string& what, Report& report) {
  if (!expect_plain(node, "a duration, as 40 us", what, report)) return std::nullopt;
  const Result<Nanoseconds> duration = parse_duration(node.text);
  if (duration) return Located<Nanoseconds>{*duration, node.at};
  const bool is_form = duration.error().code == ErrorCode::kBadInput;
  add(report, "quantity-bad", node, what + ": " + std::string(duration.error().message.view()), "a duration", {},
      is_form ? "write a number and ns, us, ms or s, with at most one space between: 40 us"
              : "write a time from 0 to 292 years, in whole nanoseconds: 40 us");
  return std::nullopt;
}

std::optional<Located<std::uint32_t>> read_whole(const Node& node, std::uint32_t min, std::uint32_t max,
                                                 const std::string& what, Report& report) {
  if (!expect_plain(node, "a whole number", what, report)) return std::nullopt;
  const auto value = whole(node.text);
  if (value && *value >= min && *value <= max)
    return Located<std::uint32_t>{static_cast<std::uint32_t>(*value), node.at};
  const std::string range = std::to_string(min) + " to " + std::to_string(max);
  add(report, "number-bad", node, what + " is " + written(node) + "; expected a whole number from " + range, range);
  return std::nullopt;
}

std::optional<Located<std::uint64_t>> read_bytes(const Node& node, std::uint64_t min, std::uint64_t max,
                                                 const std::string& what, Report& report) {
  if (!expect_plain(node, "a size, as 256 KiB", what, report)) return std::nullopt;
  const std::size_t digits = std::min(node.text.find_first_not_of("0123456789"), node.text.size());
  const auto number = whole(std::string_view(node.text).substr(0, digits));
  const std::size_t gap = digits < node.text.size() && node.text[digits] == ' ' ? 1 : 0;
  const std::string unit = node.text.substr(digits + gap);
  const std::uint64_t factor = unit == "B" ? 1 : unit == "KiB" ? 1024 : unit == "MiB" ? 1024 * 1024 : 0;
  if (number && factor != 0 && *number <= max && *number * factor >= min && *number * factor <= max)
    return Located<std::uint64_t>{*number * factor, node.at};
  const std::string range = std::to_string(min / 1024) + " KiB to " + std::to_string(max / 1024) + " KiB";
  add(report, "quantity-bad", node, what + " is " + written(node) + "; expected a size from " + range, range, {},
      "write a whole number and B, KiB or MiB, with at most one space between: 256 KiB");
  return std::nullopt;
}

std::optional<Located<std::size_t>> read_choice(const Node& node, std::span<const std::string_view> words,
                                                const std::string& what, Report& report) {
  if (node.is_scalar())
    for (std::size_t i = 0; i < words.size(); ++i)
      if (words[i] == node.text) return Located<std::size_t>{i, node.at};
  add(report, node.is_scalar() ? "word-unknown" : "value-kind", node,
      what + " is " + written(node) + "; expected one of " + listed(words), listed(words), closest(node.text, words));
  return std::nullopt;
}

bool expect(const Node& node, Node::Kind kind, const std::string& what, Report& report, bool may_be_nothing) {
  if (node.kind == kind || (may_be_nothing && node.is_none())) return true;
  const char* expected = kind == Node::Kind::kMap ? "a map" : "a list";
  add(report, "value-kind", node, what + " is " + written(node) + "; expected " + expected, expected, {},
      kind == Node::Kind::kMap ? "write 'key: value' lines below it, or {key: value}" : "write [one, two]");
  return false;
}

void refuse_unknown_keys(const Node& map, std::span<const std::string_view> keys, const std::string& what,
                         Report& report) {
  for (const Word& key : map.keys) {
    bool known = false;
    for (const std::string_view name : keys) known = known || name == key.text;
    if (known) continue;
    const bool glued = key.text.find(':') != std::string::npos;
    const std::string near = closest(key.text, keys);
    report.add({.rule = "key-unknown",
                .at = key.at,
                .message = what + " has no key '" + key.text + "'",
                .found = key.text,
                .expected = listed(keys),
                .nearest = near,
                .remedy = glued          ? "a space must follow the ':'"
                          : near.empty() ? "its keys are " + listed(keys)
                                         : ""});
  }
}

std::string listed(std::span<const std::string_view> names) { return list(names); }
std::string listed(std::span<const std::string> names) { return list(names); }

std::string closest(std::string_view word, std::span<const std::string_view> names) {
  const std::vector<std::string> candidates(names.begin(), names.end());
  return nearest(word, candidates);
}

}  // namespace chimera
