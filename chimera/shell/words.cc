// SPDX-License-Identifier: Apache-2.0
// Splits a line into words and finds completions.
#include "chimera/shell/words.h"

#include <algorithm>
#include <nlohmann/json.hpp>

#include "chimera/shell/command.h"
#include "chimera/shell/fields.h"

namespace chimera::shell {
namespace {

/// What the words behind a command are.
enum class Takes : char { kNothing, kTasks, kVariables, kSettings, kUpDown, kCommands };

Takes taken_by(std::string_view command) {
  for (const char* signal : {"spawn", "on", "off", "kill", "clear", "reinit", "ring"})
    if (command == signal) return Takes::kTasks;
  for (const char* reader : {"get", "watch", "why", "scope"})
    if (command == reader) return Takes::kVariables;
  if (command == "set") return Takes::kSettings;
  if (command == "flag") return Takes::kUpDown;
  return command == "help" ? Takes::kCommands : Takes::kNothing;
}

std::vector<std::string> candidates(const std::vector<std::string>& words, const Names& names) {
  std::vector<std::string> all;
  const Takes takes = words.empty() ? Takes::kCommands : taken_by(words[0]);
  switch (takes) {
    case Takes::kCommands:
      for (const Command& command : commands()) all.emplace_back(command.name);
      break;
    case Takes::kTasks:
      all = names.tasks;
      // `on` takes a configuration for all of its tasks.
      if (words[0] == "on") all.insert(all.end(), names.configurations.begin(), names.configurations.end());
      break;
    case Takes::kVariables: all = names.variables; break;
    case Takes::kSettings:
      if (words.size() == 1) all = names.operators;
      break;
    case Takes::kUpDown: all = {"up", "down"}; break;
    case Takes::kNothing: break;
  }
  return all;
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

Names names_of(const nlohmann::json& described) {
  Names names;
  for (const auto& task : field(described, "tasks")) names.tasks.push_back(text_of(task, "task"));
  for (const auto& variable : field(described, "variables")) {
    if (truth_of(variable, "constant")) continue;
    names.variables.push_back(text_of(variable, "variable"));
    if (truth_of(variable, "given")) names.operators.push_back(names.variables.back());
  }
  for (const auto& set : field(described, "configurations")) names.configurations.push_back(text_of(set, "name"));
  return names;
}

std::vector<std::string> completions(std::string_view before, const Names& names) {
  const std::size_t space = before.find_last_of(" \t");
  const std::string_view last = space == std::string_view::npos ? before : before.substr(space + 1);
  const auto words = words_of(before.substr(0, before.size() - last.size()));
  if (!words) return {};
  std::vector<std::string> fitting;
  for (const std::string& word : candidates(words.value(), names))
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

}  // namespace chimera::shell
