// SPDX-License-Identifier: Apache-2.0
// Takes a line apart and finds its command.
#include "firmware/shell/command_line.h"

namespace chimera::firmware {
namespace {

constexpr CommandSpec kCommands[] = {
    {"status", Verb::kStatus, Operand::kNone, 0, ""},
    {"spawn", Verb::kSpawn, Operand::kTask, 1, "TASK"},
    {"on", Verb::kOn, Operand::kTask, 8, "TASK..."},
    {"off", Verb::kOff, Operand::kTask, 8, "TASK..."},
    {"kill", Verb::kKill, Operand::kTask, 1, "TASK"},
    {"clear", Verb::kClear, Operand::kTask, 1, "TASK"},
    {"reinit", Verb::kReinit, Operand::kTask, 1, "TASK"},
    {"switch", Verb::kSwitch, Operand::kConfiguration, 1, "CONFIGURATION"},
    {"get", Verb::kGet, Operand::kVariable, 1, "VARIABLE"},
    {"set", Verb::kSet, Operand::kVariable, 10, "VARIABLE VALUE... [UNIT]"},
    {"profile", Verb::kProfile, Operand::kTask, 1, "TASK"},
    {"events", Verb::kEvents, Operand::kNone, 0, ""},
    {"help", Verb::kHelp, Operand::kNone, 0, ""},
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
    if (parsed.words.begin()[0] == each.name) parsed.command = &each;
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
