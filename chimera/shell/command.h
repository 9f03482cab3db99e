// SPDX-License-Identifier: Apache-2.0
// The commands on a running subsystem: their names, operands, options and help, in one table for the command line, the
// shell and its completion.
#pragma once

#include <cstddef>
#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "chimera/base/result.h"

namespace chimera::shell {

struct Option {
  const char* name;   ///< "--since"
  const char* value;  ///< what it takes, for help: "N"; nullptr: a flag
  const char* help;
};

struct Command {
  const char* name;
  const char* operands;      ///< "TASK..."
  std::size_t least, most;   ///< number of operands
  const char* help;
  std::vector<Option> options;  ///< besides --json and --subsystem
  const char* example;
  bool is_shells = false;       ///< understood inside `chimera shell` only
  const char* legend = "";      ///< what the columns mean
};

/// In the order of the alphabet. Context of all: setup.
const std::vector<Command>& commands();
/// nullptr when there is none of that name.
const Command* command_named(std::string_view name);

/// A command as somebody gave it, however it was typed.
struct Call {
  const Command* command = nullptr;
  std::vector<std::string> operands;
  std::map<std::string, std::string, std::less<>> options;  ///< by name; a flag has ""
  bool json = false;

  bool has(std::string_view option) const { return options.find(option) != options.end(); }
  /// Changes something, or names a process to somebody who will: not to be done to a subsystem that only happens to be
  /// the one that runs.
  bool is_act() const;
  /// The value of an option, or "".
  std::string value(std::string_view option) const;
};

/// Reads the words of a line of the shell. Refuses, saying what is wrong and the nearest name: an unknown command or
/// option, an option without its value, too few or too many operands. Requires: at least one word.
Result<Call> read_call(const std::vector<std::string>& words);

/// `call` as it is typed at a command line: "chimera set kp '[100 90] N.m/rad'".
std::string command_line(const Call& call);

/// What `help` prints: a line for each command, or more of one; "" when there is none of that name.
std::string help_text(std::string_view command = {});

}  // namespace chimera::shell
