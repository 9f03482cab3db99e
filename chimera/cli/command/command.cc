// SPDX-License-Identifier: Apache-2.0
// Reads and writes calls of commands by their rows: the words of a command line, its help, a call typed again.
#include "chimera/cli/command/command.h"

#include <algorithm>
#include <charconv>
#include <cstdint>
#include <cstdlib>
#include <sstream>
#include <utility>

#include "chimera/base/hosted/wording.h"
#include "chimera/text/nearest.h"

namespace chimera::cli {
namespace {

using Words = std::span<const std::string>;

/// Words of other programs for a command.
struct OtherWord {
  std::string_view word, meant;
};
constexpr OtherWord kOtherWords[] = {{"stop", "end"},   {"halt", "end"},   {"shutdown", "end"}, {"start", "run"},
                                     {"ls", "list"},    {"ps", "status"},  {"log", "events"},   {"logs", "events"},
                                     {"plot", "scope"}, {"info", "describe"}};

constexpr Option kHelpOption{
    .name = "--help", .help = "Print this help and exit", .manual = "The usage of this command.", .letter = "-h"};

/// Only the program has --subsystem: the shell stays with one.
std::vector<Option> options_of(const Command& command, std::string_view program) {
  std::vector<Option> all = options_of(command);
  if (command.which != nullptr && program.empty()) all.pop_back();
  return all;
}

/// "chimera new app"; in the shell "status".
std::string typed_name(std::string_view program, std::string_view command) {
  return std::string(program) + (program.empty() || command.empty() ? "" : " ") + std::string(command);
}

/// False for a lone '-' and for a negative number.
bool is_option(const std::string& word) {
  if (word.size() < 2 || word[0] != '-') return false;
  char* end = nullptr;
  (void)std::strtod(word.c_str(), &end);
  return end == word.c_str();
}

/// "{dot,svg}" of "dot svg".
std::string choices(const Option& option) {
  std::string text = std::string("{") + option.words + "}";
  std::ranges::replace(text, ' ', ',');
  return text;
}

/// The fault of a value of `option`; "": none.
std::string fault_of(const Option& option, const std::string& value) {
  if (option.kind == WordKind::kFile && value.empty()) return "names no file";
  if (option.kind == WordKind::kOneOf) {
    std::istringstream words(option.words);
    for (std::string word; words >> word;)
      if (word == value) return "";
    return value + " not in " + choices(option);
  }
  if (option.kind != WordKind::kNumber) return "";
  const auto least = static_cast<std::uint64_t>(option.least);
  const std::uint64_t most = option.most < 0 ? UINT64_MAX : static_cast<std::uint64_t>(option.most);
  std::uint64_t number = 0;
  const char* const end = value.data() + value.size();
  const auto [read_to, error] = std::from_chars(value.data(), end, number);
  if (error == std::errc() && read_to == end && number >= least && number <= most) return "";
  return "'" + value + "' is not a whole number from " + std::to_string(least) + " to " +
         (option.most < 0 ? "2^64-1" : std::to_string(most));
}

/// Reads one command line. The first fault is kept.
class Reader {
 public:
  Reader(Table table, std::string_view program) : table_(table), program_(program) {}
  CallReading read(Words words);

 private:
  void wrong(const std::string& fault) {
    if (reading_.fault.empty()) reading_.fault = fault;
  }
  /// For the end of a fault about the commands of `command`; "": of the program.
  std::string list_of(std::string_view command) const {
    return "; `" + (program_.empty() ? "help" : typed_name(program_, command) + " --help") + "` lists them";
  }
  void no_option(std::string_view command, const std::string& word, const std::vector<Option>& options);
  Words before_command(Words words);
  Words find_command(Words words);
  void take(Words words);
  void take_operand(Words words, std::size_t i);
  void take_option(Words words, std::size_t& i);
  void add(const Option& option, const std::string& value);
  void judge();

  Table table_;
  std::string_view program_;
  CallReading reading_;
  std::vector<Option> options_;  // of the command
};

void Reader::no_option(std::string_view command, const std::string& word, const std::vector<Option>& options) {
  wrong(typed_name(program_, command) + " has no option " + in_quotes(word) +
        did_you_mean(nearest(word.substr(0, word.find('=')), chimera::names_of(options, &Option::name))));
}

/// The options in front of the command.
Words Reader::before_command(Words words) {
  std::size_t n = 0;
  for (; n < words.size() && is_option(words[n]) && command_named(table_, words[n]) == nullptr; ++n) {
    const std::string name = words[n].substr(0, words[n].find('='));
    if (name == kHelpOption.name || name == kHelpOption.letter) reading_.is_help = true;
    else if (words[n] == "--subsystem") n = std::min(n + 1, words.size() - 1);
    else if (name != "--json" && name != "--subsystem")
      no_option("", words[n], {kHelpOption, {.name = "--version"}, {.name = "--json"}, {.name = "--subsystem"}});
  }
  if (!reading_.fault.empty()) reading_.fault += list_of("");
  return words.first(n);
}

/// Finds the command by the first of `words`, and returns those behind its name.
Words Reader::find_command(Words words) {
  const Command*& command = reading_.call.command;
  std::string name;
  while (!words.empty() && (command == nullptr || (command->has_commands && !is_option(words[0])))) {
    const std::string above = std::exchange(name, typed_name(name, words[0]));
    words = words.subspan(1);
    command = command_named(table_, name);
    if (command != nullptr) continue;
    const auto names = chimera::names_of(table_, [](const Command* row) { return row->name; });
    const auto other = std::ranges::find(kOtherWords, std::string_view(name), &OtherWord::word);
    const bool is_meant = other != std::end(kOtherWords) && command_named(table_, other->meant) != nullptr;
    wrong((is_meant ? "no command " + in_quotes(name) + did_you_mean(other->meant) : no_such("command", name, names)) +
          list_of(above));
    return words;
  }
  if (command == nullptr) wrong("no command is given" + list_of(""));
  return words;
}

void Reader::take(Words words) {
  bool is_behind = false;  // "--"
  for (std::size_t i = 0; i < words.size(); ++i) {
    if (is_behind || !is_option(words[i])) take_operand(words, i);
    else if (words[i] == "--") is_behind = true;
    else take_option(words, i);
  }
}

void Reader::take_operand(Words words, std::size_t i) {
  Call& call = reading_.call;
  if (call.operands.size() < call.command->most) return call.operands.push_back(words[i]);
  // A surplus word behind the value of an option is most often the unit of a value without quotes.
  const bool is_unit = i > 1 && words[i - 2].starts_with("--") &&
                       words[i - 1].find_first_not_of("+-.0123456789e") == std::string::npos;
  const std::string text = "'" + words[i] + "' is one word too many", option = is_unit ? words[i - 2] + " " : "";
  wrong(is_unit ? text + ": quote the value, " + option + "'" + words[i - 1] + " " + words[i] + "', or write " +
                      option + words[i - 1] + words[i]
                : text);
}

void Reader::take_option(Words words, std::size_t& i) {
  const std::string& word = words[i];
  const std::size_t sign = word.find('=');
  const std::string name = word.substr(0, sign);
  const auto found = std::ranges::find_if(options_, [&name](const Option& option) {
    return name == option.name || (option.letter != nullptr && name == option.letter);
  });
  Call& call = reading_.call;
  if (found == options_.end()) return no_option(call.command->name, word, options_);
  if (found->value != nullptr && found->repeats == Option::Repeats::kNo && call.has(found->name))
    wrong(name + " is given twice");
  call.options[found->name];
  if (found->value == nullptr) return sign == std::string::npos ? void() : wrong(name + " takes no value");
  std::vector<std::string> values;
  if (sign != std::string::npos) values.push_back(word.substr(sign + 1));
  const std::size_t wanted = std::string_view(found->value).find(' ') == std::string_view::npos ? 1 : 2;
  while (values.size() < wanted && i + 1 < words.size()) values.push_back(words[++i]);
  if (values.size() < wanted || sign + 1 == word.size()) wrong(name + " needs a value: " + found->value);
  // A list leaves the last words for operands that are still missing.
  const std::size_t missing = std::max(call.command->least, call.operands.size()) - call.operands.size();
  while (found->repeats == Option::Repeats::kManyEach && i + 1 + missing < words.size() && !is_option(words[i + 1]))
    values.push_back(words[++i]);
  for (const std::string& value : values) add(*found, value);
}

/// Adds a value, or each part of one that has a separator.
void Reader::add(const Option& option, const std::string& value) {
  std::istringstream in(value);
  do {
    std::string part;
    std::getline(in, part, option.separator);
    if (const std::string fault = fault_of(option, part); !fault.empty()) wrong(option.name + (": " + fault));
    reading_.call.options[option.name].push_back(part);
  } while (in.good());
}

/// Judges the call as a whole.
void Reader::judge() {
  Call& call = reading_.call;
  const Command& command = *call.command;
  reading_.is_help = call.options.erase(kHelpOption.name) > 0;
  call.json = call.options.erase("--json") > 0;
  const std::string name = typed_name(program_, command.name), given = call.operand(0), operands = command.operands;
  const std::size_t sign = given.find('=', 1);
  if (command.has_commands) wrong(name + " needs a command");
  if (call.operands.size() < command.least && command.operand_kind == WordKind::kSetting && sign < given.size())
    wrong(std::string(command.name) + " takes a name and a value, two words: " + name + " " + given.substr(0, sign) +
          " '" + given.substr(sign + 1) + "'");
  if (call.operands.size() < command.least) wrong(operands.substr(0, operands.find("...")) + " is required");
  for (const Option& option : command.options) {
    if (option.is_required && !call.has(option.name)) wrong(std::string(option.name) + " is required");
    if (option.excludes == nullptr || !call.has(option.name)) continue;
    const std::string other = option.excludes;
    if (other.starts_with("--") ? call.has(other) : !call.operands.empty()) wrong(other + " excludes " + option.name);
  }
}

CallReading Reader::read(Words words) {
  const Words before = program_.empty() ? Words() : before_command(words);
  if (reading_.is_help || !reading_.fault.empty()) return reading_;
  Call& call = reading_.call;
  words = find_command(words.subspan(before.size()));
  if (call.command == nullptr) return reading_;
  options_ = options_of(*call.command, program_);
  take(before);
  auto first = std::exchange(call.options, {});
  take(words);
  call.options.merge(first);  // an option behind the command wins
  judge();
  return reading_;
}

/// A line of the help in two columns; two lines if the left text is too long.
std::string help_line(const std::string& left, const std::string& right) {
  constexpr std::size_t kWidth = 30;
  const bool fits = left.size() + 2 < kWidth;
  return "  " + left + (fits ? "" : "\n") + std::string(fits ? kWidth - 2 - left.size() : kWidth, ' ') + right + "\n";
}

std::string help_line(const Option& option) {
  std::string left = (option.letter == nullptr ? "" : std::string(option.letter) + ",") + option.name;
  if (option.value != nullptr) left += std::string(" ") + option.value;
  if (option.kind == WordKind::kOneOf) left += ":" + choices(option);
  if (option.repeats != Option::Repeats::kNo && !left.ends_with("...")) left += " ...";
  if (option.is_required) left += " REQUIRED";
  if (option.excludes != nullptr) left += std::string(" (not with ") + option.excludes + ")";
  return help_line(left, option.help);
}

/// A line for each command of `above`; "": of the program. Rare ones have a heading of their own.
std::string help_lines(Table table, std::string_view above) {
  std::string text, rare;
  for (const Command* row : commands_of(table, above))
    (row->is_rare ? rare : text) += help_line(std::string(last_word(row->name)) + " " + row->operands, row->help);
  return text + (rare.empty() ? "" : "\nSeldom needed:\n" + rare);
}

std::string examples(std::string text) {
  if (text.empty()) return text;
  const bool is_one = text.find('\n') == std::string::npos;
  for (std::size_t at = 0; (at = text.find('\n', at)) != std::string::npos; ++at) text.insert(at + 1, 10, ' ');
  return (is_one ? "Example: " : "Examples: ") + text + "\n";
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

std::vector<const Command*> commands_of(Table table, std::string_view above) {
  std::vector<const Command*> found;
  for (const Command* row : table)
    if (!row->is_hidden && std::string(row->name) == typed_name(above, last_word(row->name))) found.push_back(row);
  return found;
}

std::string_view last_word(std::string_view name) { return name.substr(name.find(' ') + 1); }

std::vector<Option> options_of(const Command& command) {
  std::vector<Option> all = {kHelpOption};
  all.insert(all.end(), command.options.begin(), command.options.end());
  const bool is_raw = command.which != nullptr;
  if (command.json != nullptr)
    all.push_back({.name = "--json",
                   .help = command.json,
                   .manual = is_raw ? "The raw answer, as docs/formats/control.md has it." : nullptr});
  if (command.which != nullptr) all.push_back({.name = "--subsystem", .value = "NAME", .help = command.which});
  return all;
}

CallReading read_call(Table table, std::span<const std::string> words, std::string_view program) {
  CallReading reading = Reader(table, program).read(words);
  const Command* command = reading.call.command;
  if (reading.is_help) reading.fault.clear();
  if (reading.fault.empty()) return reading;
  reading.fault += "\n";
  if (command == nullptr) return reading;
  const std::string example = examples(command->example);
  if (example.starts_with("Example: ")) reading.fault += example;
  reading.fault += "`" + typed_name(program, command->name) + " --help` says more\n";
  return reading;
}

std::string command_line(const Call& call) {
  std::string text = std::string("chimera ") + call.command->name;
  for (const std::string& operand : call.operands) text += " " + shell_word(operand);
  for (const auto& [option, values] : call.options) {
    if (values.empty()) text += " " + option;
    for (const std::string& value : values) text += " " + option + " " + shell_word(value);
  }
  return text + (call.json ? " --json" : "");
}

std::string help_text(Table table, const Command* command, std::string_view program) {
  if (command == nullptr) return help_lines(table, "");
  const std::string operands = command->has_commands ? "COMMAND" : command->operands;
  std::string text = std::string(command->help) + "\nUsage: " + typed_name(program, command->name) + " [OPTIONS]" +
                     (operands.empty() ? "" : " " + operands) + "\n\n";
  if (command->most > 0) text += help_line(operands, command->operand_help) + "\n";
  text += "Options:\n";
  for (const Option& option : options_of(*command, program)) text += help_line(option);
  if (command->has_commands) text += "\nCommands:\n" + help_lines(table, command->name);
  const std::string footer = command->footer, end = examples(command->example);
  return text + (footer.empty() && end.empty() ? "" : "\n") + footer + (footer.empty() ? "" : "\n") + end;
}

}  // namespace chimera::cli
