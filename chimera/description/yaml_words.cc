// SPDX-License-Identifier: Apache-2.0
// Writes values of a description in one line and reads them back.
#include "chimera/description/yaml_words.h"

#include <algorithm>

#include "chimera/base/hosted/terminal_text.h"
#include "chimera/base/hosted/wording.h"
#include "chimera/description/yaml_reader.h"
#include "chimera/text/json_text.h"

namespace chimera {
namespace {

/// True if `before` + `text` + `after` is a list or map whose first item is the plain text.
bool reads_back(std::string_view text, std::string_view before, std::string_view after) {
  Report report;
  std::string all(before);
  all.append(text).append(after);
  const auto tree = read_yaml(all, report);
  if (!tree || !report.is_legal() || tree->items.size() != 1) return false;
  const Node& item = tree->items[0];
  return item.is_scalar() && !item.quoted && item.text == text;
}

/// True for most names and quantities: text that is plain everywhere.
bool is_surely_plain(std::string_view text) {
  constexpr std::string_view kLetters = "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ";
  constexpr std::string_view kDigits = "0123456789", kRest = "0123456789_./()+- ";
  const auto is_in = [](std::string_view set, char c) { return set.find(c) != std::string_view::npos; };
  const char first = text.size() > 1 && text[0] == '-' ? text[1] : text.empty() ? ' ' : text[0];
  if (!is_in(kDigits, first) && (!is_in(kLetters, first) || text[0] == '-')) return false;
  if (text.back() == ' ') return false;
  if (text.size() == 4 && (text[0] == 'n' || text[0] == 'N')) return false;  // null
  return std::all_of(text.begin(), text.end(), [&](char c) { return is_in(kLetters, c) || is_in(kRest, c); });
}

/// Without places, and with quotes that let each text stand in brackets as well.
void make_portable(Node& node) {
  node.at = {};
  node.quoted = node.quoted || (node.is_scalar() && needs_quotes(node.text, true));
  for (Word& key : node.keys) key.at = {};
  for (Node& item : node.items) make_portable(item);
}

}  // namespace

bool needs_quotes(std::string_view text, bool in_brackets) {
  if (is_surely_plain(text)) return false;
  if (text.find_first_of("\r\n") != std::string_view::npos) return true;
  if (in_brackets) return !reads_back(text, "[", "]\n") || !reads_back(text, "{k: ", "}\n");
  return !reads_back(text, "- ", "\n") || !reads_back(text, "k: ", "\n");
}

std::string quoted_words(std::string_view text, char quote) {
  const auto is_control = [](char c) { return static_cast<unsigned char>(c) < 0x20; };
  if (quote != '\'' || std::any_of(text.begin(), text.end(), is_control)) return json_string(text);
  std::string words = "'";
  for (const char c : text) words.append(c == '\'' ? 2 : 1, c);
  return words + "'";
}

std::string written_text(const Node& value, bool in_brackets) {
  if (value.is_none()) return {};
  if (value.is_scalar())
    return value.quoted || needs_quotes(value.text, in_brackets) ? quoted_words(value.text, '"') : value.text;
  const std::string words = join_n(value.items.size(), ", ", [&value](std::size_t i) {
    if (!value.is_map()) return written_text(value.items[i], true);
    const std::string& key = value.keys[i].text;
    return (needs_quotes(key, true) ? quoted_words(key, '"') : key) + ": " + written_text(value.items[i], true);
  });
  return value.is_map() ? "{" + words + "}" : "[" + words + "]";
}

Result<Node> value_of(std::string_view words) {
  Report report;
  const bool is_one_line = words.find_first_of("\r\n") == std::string_view::npos;
  auto tree = is_one_line ? read_yaml("value: " + std::string(words) + "\n", report) : std::nullopt;
  const Node* value = tree && tree->keys.size() == 1 ? tree->find("value") : nullptr;
  if (value == nullptr || value->is_none() || !report.is_legal())
    return Error{ErrorCode::kBadInput, {"'" + plain_line(words.substr(0, 100)) + "' is no value"}, {}};
  Node made = *value;
  make_portable(made);
  return made;
}

bool is_same(const Node& a, const Node& b) {
  if (a.kind != b.kind || a.items.size() != b.items.size() || a.keys.size() != b.keys.size()) return false;
  if (a.is_scalar()) return a.text == b.text && a.quoted == b.quoted;
  for (std::size_t i = 0; i < a.keys.size(); ++i)
    if (a.keys[i].text != b.keys[i].text) return false;
  for (std::size_t i = 0; i < a.items.size(); ++i)
    if (!is_same(a.items[i], b.items[i])) return false;
  return true;
}

}  // namespace chimera
