// SPDX-License-Identifier: Apache-2.0
// Reads and writes calls of commands by their rows: a line of the shell, its help, a call typed again.
#include "chimera/cli/command/command.h"

#include <algorithm>

#include "chimera/text/nearest.h"

namespace chimera::cli {
namespace {

Error bad_call(const std::string& message) { return {ErrorCode::kBadInput, std::string_view(message), {}}; }

std::string with_nearest(const std::string& message, const std::string& wrong, const std::vector<std::string>& names) {
  const std::string near = nearest(wrong, names);
  return near.empty() ? message : message + "; did you mean '" + near + "'?";
}

/// "--since N".
std::string with_value(const Option& option) {
  return std::string(option.name) + (option.value ? std::string(" ") + option.value : "");
}

std::string usage(const Command& command) {
  std::string text = command.name;
  if (*command.operands != '\0') text += std::string(" ") + command.operands;
  for (const Option& option : command.options) text += " [" + with_value(option) + "]";
  return text;
}

/// Takes the option at words[i], and its value if it has one.
Result<void> read_option(Call& call, const std::vector<std::string>& words, std::size_t& i) {
  if (words[i] == "--json") return call.json = true, Result<void>();
  std::vector<std::string> names = {"--json"};
  for (const Option& option : call.command->options) {
    names.emplace_back(option.name);
    if (words[i] != option.name) continue;
    if (option.value == nullptr) return call.options[option.name] = {}, Result<void>();
    if (i + 1 == words.size()) return bad_call(words[i] + " needs a value: " + option.value);
    ++i;
    return call.options[option.name].push_back(words[i]), Result<void>();
  }
  return bad_call(with_nearest(std::string(call.command->name) + " has no option '" + words[i] + "'", words[i], names));
}

/// `word` in quotes where a shell would else cut or change it.
std::string quoted(const std::string& word) {
  const char* plain = "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789_./:=+,@%-";
  if (!word.empty() && word.find_first_not_of(plain) == std::string::npos) return word;
  std::string text = "'";
  for (const char c : word) text += c == '\'' ? std::string("'\\''") : std::string(1, c);
  return text + "'";
}

/// A column of the help: `text` and at least one blank; a longer one stands as it is.
std::string column(const std::string& text) {
  constexpr std::size_t kWidth = 18;
  return text.size() < kWidth ? text + std::string(kWidth - text.size(), ' ') : text + " ";
}

/// Every line but the first behind `margin`.
std::string indented(std::string text, const std::string& margin) {
  for (std::size_t at = 0; (at = text.find('\n', at)) != std::string::npos; at += 1 + margin.size())
    text.replace(at, 1, "\n" + margin);
  return text;
}

}  // namespace

std::string Call::value(std::string_view option) const {
  const auto found = options.find(option);
  return found == options.end() || found->second.empty() ? "" : found->second.back();
}

std::vector<std::string> Call::values(std::string_view option) const {
  const auto found = options.find(option);
  return found == options.end() ? std::vector<std::string>() : found->second;
}

bool Call::is_act() const {
  return command->is_act || std::ranges::any_of(command->options, [this](const Option& option) {
           return option.is_act && has(option.name);
         });
}

const Command* command_named(Table table, std::string_view name) {
  const auto found = std::ranges::find(table, name, &Command::name);
  return found == table.end() ? nullptr : *found;
}

Result<Call> read_call(Table table, const std::vector<std::string>& words) {
  Call call;
  call.command = command_named(table, words.at(0));
  if (call.command == nullptr) {
    std::vector<std::string> names;
    for (const Command* command : table) names.emplace_back(command->name);
    return bad_call(with_nearest("no command '" + words[0] + "'", words[0], names) + "; `help` lists them");
  }
  for (std::size_t i = 1; i < words.size(); ++i) {
    if (!words[i].starts_with("--")) {
      call.operands.push_back(words[i]);
    } else if (const auto read = read_option(call, words, i); !read) {
      return read.error();
    }
  }
  if (call.operands.size() < call.command->least || call.operands.size() > call.command->most)
    return bad_call("usage: " + usage(*call.command));
  return call;
}

std::string command_line(const Call& call) {
  std::string text = std::string("chimera ") + call.command->name;
  for (const std::string& operand : call.operands) text += " " + quoted(operand);
  for (const auto& [option, values] : call.options) {
    if (values.empty()) text += " " + option;
    for (const std::string& value : values) text += " " + option + " " + quoted(value);
  }
  return text + (call.json ? " --json" : "");
}

std::string help_text(Table table, std::string_view name) {
  std::string text;
  if (name.empty()) {
    for (const Command* command : table)
      text += column(std::string(command->name) + " " + command->operands) + command->help + "\n";
    return text;
  }
  const Command* command = command_named(table, name);
  if (command == nullptr) return "";
  text = usage(*command) + "\n  " + command->help + "\n";
  for (const Option& option : command->options) text += "  " + column(with_value(option)) + option.help + "\n";
  if (*command->footer != '\0') text += "  " + indented(command->footer, "  ") + "\n";
  return text + "  Example: " + command->example + "\n";
}

}  // namespace chimera::cli
