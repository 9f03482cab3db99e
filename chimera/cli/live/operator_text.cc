// SPDX-License-Identifier: Apache-2.0
// Finds the values under `operator:` in the text of a description and replaces them in place.
#include "chimera/cli/live/operator_text.h"

#include <algorithm>
#include <cmath>

#include "chimera/base/hosted/wording.h"
#include "chimera/description/draft.h"
#include "chimera/description/yaml_reader.h"
#include "chimera/verify/setting.h"

namespace chimera::cli {
namespace {

Error no_edit(const std::string& message, const std::string& where = {}) {
  return {ErrorCode::kRefused, std::string_view(message), std::string_view(where)};
}

std::size_t offset_of(std::string_view text, Place at) {
  std::size_t offset = 0;
  for (std::uint32_t line = 1; line < at.line && offset != std::string_view::npos; ++line) {
    offset = text.find('\n', offset);
    if (offset != std::string_view::npos) ++offset;
  }
  return offset == std::string_view::npos ? text.size() : std::min(offset + at.column - 1, text.size());
}

/// End of what is quoted from `at` on.
std::size_t quoted_end(std::string_view text, std::size_t at) {
  const char quote = text[at];
  for (std::size_t i = at + 1; i < text.size(); ++i) {
    const bool is_escape = quote == '"' && text[i] == '\\';
    const bool is_doubled = quote == '\'' && text.substr(i, 2) == "''";
    if (is_escape || is_doubled) ++i;
    else if (text[i] == quote) return i + 1;
  }
  return text.size();
}

bool begins_comment(std::string_view text, std::size_t at) {
  return text[at] == '#' && at > 0 && (text[at - 1] == ' ' || text[at - 1] == '\t' || text[at - 1] == '\n');
}

/// End of a list or map in brackets.
std::size_t bracket_end(std::string_view text, std::size_t at) {
  int depth = 0;
  for (std::size_t i = at; i < text.size(); ++i) {
    const char c = text[i];
    if (begins_comment(text, i)) i = std::min(text.find('\n', i), text.size() - 1);
    else if (c == '"' || c == '\'') i = quoted_end(text, i) - 1;
    else if (c == '[' || c == '{') ++depth;
    else if ((c == ']' || c == '}') && --depth == 0) return i + 1;
  }
  return text.size();
}

std::size_t plain_end(std::string_view text, std::size_t at, bool is_in_brackets) {
  std::size_t end = at;
  while (end < text.size() && text[end] != '\n' && !begins_comment(text, end) &&
         !(is_in_brackets && (text[end] == ',' || text[end] == '}' || text[end] == ']')))
    ++end;
  while (end > at && (text[end - 1] == ' ' || text[end - 1] == '\t' || text[end - 1] == '\r')) --end;
  return end;
}

/// A value written as lines of its own ("- 1"): these are replaced one by one, so that what stands between them stays.
bool is_block(const Node& value, std::string_view text, std::size_t at) {
  return (value.is_list() && text[at] != '[') || (value.is_map() && text[at] != '{');
}

struct Edit {
  std::size_t from = 0, to = 0;
  std::string with;
};

// ---- the values ----

bool same_scalar(const Node& a, const Node& b, const UnitSystem& units) {
  if (a.text == b.text) return true;
  const auto x = parse_quantity(a.text, units), y = parse_quantity(b.text, units);
  if (!x || !y) return false;
  const auto in_unit = value_in(x.value(), y.value().unit, y.value().unit_text);
  return in_unit && std::fabs(in_unit.value() - y.value().value) <= 1e-12 * std::fabs(y.value().value);
}

/// Whether `now` says what `before` says; a value that is no list fills all elements.
bool same_value(const Node& before, const Node& now, const UnitSystem& units) {
  if (now.is_list() && !before.is_list())
    return std::all_of(now.items.begin(), now.items.end(),
                       [&](const Node& item) { return same_value(before, item, units); });
  if (before.kind != now.kind || before.items.size() != now.items.size()) return false;
  if (before.is_scalar()) return same_scalar(before, now, units);
  for (std::size_t i = 0; i < before.items.size(); ++i) {
    const Node* item = before.is_map() ? now.find(before.keys[i].text) : &now.items[i];
    if (item == nullptr || !same_value(before.items[i], *item, units)) return false;
  }
  return true;
}

Result<Node> node_of(const std::string& name, const std::string& words) {
  Report report;
  const auto tree = read_yaml("value: " + words + "\n", report);
  const Node* value = tree ? tree->find("value") : nullptr;
  if (value == nullptr || !report.is_legal()) return no_edit("'" + words + "' is no value", name);
  return *value;
}

bool is_in_brackets(std::string_view text, const Draft& draft) {
  const std::size_t at = offset_of(text, draft.operators[0].name.at);
  const std::size_t before = text.find_last_not_of(" \t\r\n", at == 0 ? 0 : at - 1);
  return before != std::string_view::npos && text[before] == '{';
}

struct Editing {
  std::string_view text;
  const UnitSystem& units;
  bool is_in_brackets;
};

/// Adds edits that replace the value `given` by `words`, whose value is `now`. A value in a block of lines is replaced
/// item by item. False if the block and `now` differ in kind or number of items.
bool add_edits(const Node& given, const Node& now, const std::string& words, const Editing& in,
               std::vector<Edit>& edits) {
  if (same_value(given, now, in.units)) return true;
  const std::string_view text = in.text;
  const std::size_t at = offset_of(text, given.at);
  if (given.is_none() || at >= text.size()) return false;
  if (is_block(given, text, at)) {
    if (given.kind != now.kind || given.items.size() != now.items.size()) return false;
    for (std::size_t i = 0; i < given.items.size(); ++i) {
      const Node* item = given.is_map() ? now.find(given.keys[i].text) : &now.items[i];
      if (item == nullptr || !add_edits(given.items[i], *item, written_text(*item), in, edits)) return false;
    }
    return true;
  }
  const bool is_bracket = text[at] == '[' || text[at] == '{';
  const bool is_quoted = text[at] == '"' || text[at] == '\'';
  edits.push_back({at, is_bracket ? bracket_end(text, at) : is_quoted ? quoted_end(text, at)
                                  : plain_end(text, at, in.is_in_brackets), words});
  return true;
}

}  // namespace

Result<std::string> with_operator_values(std::string_view text, const std::map<std::string, std::string>& values,
                                         const UnitSystem& units) {
  const ReadDescription reading = read_description(text, "");
  if (!reading.draft) return no_edit("the description cannot be read");
  const Draft& draft = *reading.draft;
  std::vector<Edit> edits;
  for (const auto& [name, words] : values) {
    const auto given = std::find_if(draft.operators.begin(), draft.operators.end(),
                                    [&key = name](const NamedNode& node) { return node.name.text == key; });
    if (given == draft.operators.end()) return no_edit("is not under `operator:`", name);
    const auto now = node_of(name, words);
    if (!now) return now.error();
    if (same_value(given->value, now.value(), units)) continue;
    if (!add_edits(given->value, now.value(), words, {text, units, is_in_brackets(text, draft)}, edits))
      return no_edit("is written over several lines, and its number of elements has changed: edit the file by hand",
                     name);
  }
  std::sort(edits.begin(), edits.end(), [](const Edit& a, const Edit& b) { return a.from > b.from; });
  std::string result(text);
  for (const Edit& edit : edits) result.replace(edit.from, edit.to - edit.from, edit.with);
  // The proof: what is read now has these values, and everything else where it was.
  const ReadDescription again = read_description(result, "");
  if (!again.draft || again.draft->operators.size() != draft.operators.size()) return no_edit("cannot be edited");
  for (const NamedNode& given : again.draft->operators) {
    const auto wanted = values.find(given.name.text);
    if (wanted == values.end()) continue;
    const auto node = node_of(wanted->first, wanted->second);
    if (!node || !same_value(given.value, node.value(), units)) return no_edit("cannot be edited", given.name.text);
  }
  return result;
}

}  // namespace chimera::cli
