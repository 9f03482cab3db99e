// SPDX-License-Identifier: Apache-2.0
#include "chimera/shell/command.h"

#include <algorithm>

#include "chimera/shell/columns.h"
#include "chimera/text/nearest.h"

namespace chimera::shell {
namespace {

constexpr std::size_t kAny = 10'000;

std::vector<Command> table() {
  const Option every{"--every", "TIME", "how often, such as '100 ms'"};
  return {
      {"clear", "TASK...", 1, kAny, "Bring tasks from ERROR to OFF", {}, "chimera clear pid"},
      {"end", "", 0, 0, "End the subsystem: off, kill, and every process", {}, "chimera end"},
      {"events", "", 0, 0, "What happened, numbered without a gap",
       {{"--since", "N", "from this number on"},
        {"--kind", "KIND,...", "only these, such as 'set,fault'"},
        {"--each", nullptr, "a line for every event; else misses within 100 ms of each other are one"},
        {"--follow", nullptr, "go on with what happens, until Ctrl-C"}},
       "chimera events --follow"},
      {"flag", "up|down", 1, 1, "Raise or lower the operator's part of the illegal-configuration flag", {},
       "chimera flag up"},
      {"get", "VAR...", 0, kAny, "Present values; without a name all",
       {{"--every", "TIME", "again and again, such as '1 s', until Ctrl-C"}}, "chimera get q kp"},
      {"help", "[COMMAND]", 0, 1, "This list, or more about one command", {}, "help set", true},
      {"kill", "TASK...", 1, kAny, "End tasks: back to NOT-CREATED", {}, "chimera kill pid"},
      {"off", "TASK...", 1, kAny, "Take tasks out of service, those of one rtpu in one step", {},
       "chimera off pid arm"},
      {"on", "TASK...", 1, kAny, "Put tasks, or those of a configuration, into service in one step", {},
       "chimera on pid arm"},
      {"profile", "", 0, 0, "What each task costs and how punctual it is",
       {{"--save", "FILE", "write it into this file, for `chimera schedule --profile`"}}, "chimera profile", false,
       "mean, max: execution time of a cycle; load: its share of the time ON; response: longest, release to end;\n"
       "jitter: latest start minus earliest, each after its release; groups, bytes: copied from other rtpus or the\n"
       "operator"},
      {"quit", "", 0, 0, "Leave the shell; the subsystem goes on", {}, "quit", true},
      {"reinit", "TASK...", 1, kAny, "Have tasks read their constants anew", {}, "chimera reinit pid"},
      {"ring", "TASK...", 1, kAny, "Ring the doorbell of tasks behind a server: one event for each", {},
       "chimera ring lamp"},
      {"save", "", 0, 0, "Show the operator's values in the words of the description",
       {{"--write", nullptr, "write them into the description file; nothing else in it changes"}},
       "chimera save --write"},
      {"scope", "VAR...", 1, kAny, "Record everything that is published, round a trigger",
       {{"--trigger", "EXPR", "begin when this comes true, such as 'error > 2 mrad'"},
        {"--pre", "TIME", "keep this much from before the trigger, such as '50 ms'"},
        {"--for", "TIME", "how long from the trigger on ('1 s')"},
        {"--wait", "TIME", "how long to wait for the trigger ('60 s')"},
        {"--csv", "FILE", "write the rows to this file"},
        {"--svg", "FILE", "draw them into this file"}},
       "chimera scope q tau --trigger 'error > 2 mrad' --pre '50 ms' --for '200 ms' --svg scope.svg"},
      {"set", "VAR VALUE", 2, kAny, "Give an operator variable a value with its unit", {},
       "chimera set kp '[100 90] N.m/rad'"},
      {"spawn", "TASK...", 1, kAny, "Create and init tasks: OFF", {}, "chimera spawn pid"},
      {"status", "", 0, 0, "Real-time units, tasks, flag",
       {{"--pid", "RTPU", "only the number of the process of this real-time unit ('keeper', 'manager': of theirs)"}},
       "chimera status"},
      {"top", "", 0, 0, "The same live, on the whole screen: q ends it", {every}, "chimera top", false,
       "EXEC: mean execution time since the last look; MAX: longest so far; USED: MAX of BUDGET; INPUT: age of the\n"
       "oldest input"},
      {"watch", "VAR...", 1, kAny, "Values live, with their recent course", {every}, "chimera watch q tau[2]"},
      {"why", "VAR", 1, 1, "Where a value comes from, and what is wrong with it", {}, "chimera why tau"},
  };
}

Error bad_call(const std::string& message) { return {ErrorCode::kBadInput, std::string_view(message), {}}; }

std::string with_nearest(const std::string& message, const std::string& wrong, const std::vector<std::string>& names) {
  const std::string near = nearest(wrong, names);
  return near.empty() ? message : message + "; did you mean '" + near + "'?";
}

std::string usage(const Command& command) {
  std::string text = command.name;
  if (*command.operands != '\0') text += std::string(" ") + command.operands;
  for (const Option& option : command.options)
    text += std::string(" [") + option.name + (option.value ? std::string(" ") + option.value : "") + "]";
  return text;
}

/// Takes the option at words[i], and its value if it has one.
Result<void> read_option(Call& call, const std::vector<std::string>& words, std::size_t& i) {
  if (words[i] == "--json") return call.json = true, Result<void>();
  std::vector<std::string> names = {"--json"};
  for (const Option& option : call.command->options) {
    names.emplace_back(option.name);
    if (words[i] != option.name) continue;
    if (option.value == nullptr) return call.options[option.name] = "", Result<void>();
    if (i + 1 == words.size()) return bad_call(words[i] + " needs a value: " + option.value);
    ++i;
    return call.options[option.name] = words[i], Result<void>();
  }
  return bad_call(with_nearest(std::string(call.command->name) + " has no option '" + words[i] + "'", words[i], names));
}

/// As a shell takes it for one word.
std::string quoted(const std::string& word) {
  const char* plain = "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789_./:=+,@%-";
  if (!word.empty() && word.find_first_not_of(plain) == std::string::npos) return word;
  std::string text = "'";
  for (const char c : word) text += c == '\'' ? std::string("'\\''") : std::string(1, c);
  return text + "'";
}

}  // namespace

const std::vector<Command>& commands() {
  static const std::vector<Command> kCommands = table();
  return kCommands;
}

const Command* command_named(std::string_view name) {
  for (const Command& command : commands())
    if (name == command.name) return &command;
  return nullptr;
}

bool Call::is_act() const {
  constexpr std::string_view kActs[] = {"clear", "end", "flag", "kill", "off", "on", "reinit", "ring", "set", "spawn"};
  const bool is_named = std::find(std::begin(kActs), std::end(kActs), command->name) != std::end(kActs);
  return is_named || has("--write") || has("--pid");
}

std::string Call::value(std::string_view option) const {
  const auto found = options.find(option);
  return found == options.end() ? "" : found->second;
}

Result<Call> read_call(const std::vector<std::string>& words) {
  Call call;
  call.command = command_named(words.at(0));
  if (call.command == nullptr) {
    std::vector<std::string> names;
    for (const Command& command : commands()) names.emplace_back(command.name);
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
  for (const auto& [option, value] : call.options) text += " " + option + (value.empty() ? "" : " " + quoted(value));
  return text + (call.json ? " --json" : "");
}

std::string help_text(std::string_view name) {
  std::string text;
  if (name.empty()) {
    for (const Command& command : commands())
      text += fitted(std::string(command.name) + " " + command.operands, 18) + command.help + "\n";
    return text;
  }
  const Command* command = command_named(name);
  if (command == nullptr) return "";
  text = usage(*command) + "\n  " + command->help + "\n";
  for (const Option& option : command->options)
    text += "  " + fitted(std::string(option.name) + (option.value ? std::string(" ") + option.value : ""), 18) +
            option.help + "\n";
  std::string legend = command->legend;
  for (std::size_t at = 0; (at = legend.find('\n', at)) != std::string::npos; at += 3) legend.replace(at, 1, "\n  ");
  if (!legend.empty()) text += "  " + legend + "\n";
  return text + "  Example: " + command->example + "\n";
}

}  // namespace chimera::shell
