// SPDX-License-Identifier: Apache-2.0
// Takes a line apart and finds its command.
#include "firmware/shell/command_line.h"

namespace chimera::firmware {
namespace {

constexpr CommandSpec kCommands[] = {
    {"status", Verb::kStatus, Operand::kNone, 0, "", "the flag, the tasks, the stacks"},
    {"spawn", Verb::kSpawn, Operand::kTask, 1, "TASK", "initialise a task: NOT-CREATED to OFF"},
    {"on", Verb::kOn, Operand::kTask, 8, "TASK...", "turn tasks ON together"},
    {"off", Verb::kOff, Operand::kTask, 8, "TASK...", "turn tasks OFF together"},
    {"kill", Verb::kKill, Operand::kTask, 1, "TASK", "end a task: to NOT-CREATED"},
    {"clear", Verb::kClear, Operand::kTask, 1, "TASK", "clear an error: ERROR to OFF"},
    {"reinit", Verb::kReinit, Operand::kTask, 1, "TASK", "read the constants of a task again"},
    {"switch", Verb::kSwitch, Operand::kConfiguration, 1, "CONFIGURATION", "switch to a configuration"},
    {"get", Verb::kGet, Operand::kVariable, 1, "VARIABLE", "show a variable"},
    {"set", Verb::kSet, Operand::kVariable, 10, "VARIABLE VALUE... [UNIT]", "give an operator variable its values"},
    {"profile", Verb::kProfile, Operand::kTask, 1, "TASK", "show times, losses and the last fault of a task"},
    {"events", Verb::kEvents, Operand::kNone, 0, "", "show the events since the last time"},
    {"help", Verb::kHelp, Operand::kNone, 0, "", "show the commands"},
};

bool is_blank(char c) noexcept { return c == ' ' || c == '\t'; }

std::string_view without_blanks(std::string_view text) noexcept {
  while (!text.empty() && is_blank(text.front())) text.remove_prefix(1);
  while (!text.empty() && is_blank(text.back())) text.remove_suffix(1);
  return text;
}

}  // namespace

std::span<const CommandSpec> commands() noexcept { return kCommands; }

CommandLine parse(std::string_view line) noexcept {
  CommandLine parsed;
  for (std::string_view rest = without_blanks(line); !rest.empty();) {
    std::size_t n = 0;
    while (n < rest.size() && !is_blank(rest[n])) ++n;
    if (!parsed.words.try_push({rest.data(), n})) {
      parsed.fault = LineFault::kTooManyWords;
      break;
    }
    rest = without_blanks({rest.data() + n, rest.size() - n});
    if (parsed.words.size() == 2) parsed.after_first = rest;
  }
  if (parsed.words.empty()) return parsed;
  for (const CommandSpec& each : kCommands)
    if (each.name == parsed.words[0]) parsed.command = &each;
  if (parsed.command == nullptr) {
    parsed.fault = LineFault::kUnknown;
  } else if (parsed.fault == LineFault::kNone) {
    const std::size_t least =
        parsed.command->operand == Operand::kNone ? 0 : parsed.command->verb == Verb::kSet ? 2 : 1;
    if (parsed.n_operands() < least) parsed.fault = LineFault::kTooFew;
    if (parsed.n_operands() > parsed.command->most) parsed.fault = LineFault::kTooMany;
  }
  return parsed;
}

}  // namespace chimera::firmware
