// SPDX-License-Identifier: Apache-2.0
// Cuts a line into words, and completes the last one by the row of its command.
#include "chimera/cli/live/words.h"

#include <algorithm>

#include "chimera/cli/print/fields.h"
#include "chimera/text/json.h"

namespace chimera::cli {
namespace {

std::vector<std::string> all_of(const std::vector<std::string>& some, const std::vector<std::string>& more) {
  std::vector<std::string> all = some;
  all.insert(all.end(), more.begin(), more.end());
  return all;
}

std::vector<std::string> names_in(Table table) {
  std::vector<std::string> names;
  for (const Command* command : table) names.emplace_back(command->name);
  return names;
}

/// Candidates for the word behind `words`.
std::vector<std::string> candidates(Table table, const std::vector<std::string>& words, const Names& names) {
  if (words.empty()) return names_in(table);
  const Command* command = command_named(table, words[0]);
  if (command == nullptr) return {};
  switch (command->operand_kind) {
    case WordKind::kTask: return names.tasks;
    case WordKind::kTaskOrConfiguration: return all_of(names.tasks, names.configurations);
    case WordKind::kVariable: return names.variables;
    case WordKind::kSetting: return words.size() == 1 ? names.operators : std::vector<std::string>();
    case WordKind::kOneOf: return words_of(command->operand_words).value();
    case WordKind::kCommand: return names_in(table);
    default: return {};
  }
}

}  // namespace

Result<std::vector<std::string>> words_of(std::string_view line) {
  std::vector<std::string> words;
  bool is_open = false;  // a word has begun
  char quote = 0;
  for (std::size_t i = 0; i < line.size(); ++i) {
    const char c = line[i];
    if (quote != 0 && c == quote) {
      quote = 0;
    } else if (quote == '\'' || (quote == '"' && c != '\\')) {
      words.back() += c;
    } else if (quote == 0 && (c == ' ' || c == '\t' || c == '\r')) {
      is_open = false;
    } else if (quote == 0 && c == '#' && !is_open) {
      break;
    } else {
      if (!is_open) words.emplace_back(), is_open = true;
      if (quote == 0 && (c == '\'' || c == '"')) quote = c;
      else if (c == '\\' && i + 1 < line.size()) words.back() += line[++i];
      else words.back() += c;
    }
  }
  if (quote == '"') return Error{ErrorCode::kBadInput, {"a \" is not closed"}, {}};
  if (quote == '\'') return Error{ErrorCode::kBadInput, {"a ' is not closed"}, {}};
  return words;
}

Names names_of(const Json& described) {
  Names names;
  for (const auto& task : described["tasks"]) names.tasks.push_back(text_of(task, "task"));
  for (const auto& variable : described["variables"]) {
    if (truth_at(variable, "constant")) continue;
    names.variables.push_back(text_of(variable, "variable"));
    if (truth_at(variable, "given")) names.operators.push_back(names.variables.back());
  }
  for (const auto& set : described["configurations"]) names.configurations.push_back(text_of(set, "name"));
  return names;
}

std::vector<std::string> completions(Table table, std::string_view before, const Names& names) {
  const std::size_t space = before.find_last_of(" \t");
  const std::string_view last = space == std::string_view::npos ? before : before.substr(space + 1);
  const auto words = words_of(before.substr(0, before.size() - last.size()));
  if (!words) return {};
  std::vector<std::string> fitting;
  for (const std::string& word : candidates(table, words.value(), names))
    if (word.starts_with(last)) fitting.push_back(word);
  return fitting;
}

std::string shared_beginning(const std::vector<std::string>& words) {
  if (words.empty()) return "";
  std::string shared = words[0];
  for (const std::string& word : words) {
    std::size_t n = 0;
    while (n < shared.size() && n < word.size() && shared[n] == word[n]) ++n;
    shared.resize(n);
  }
  return shared;
}

}  // namespace chimera::cli
