// SPDX-License-Identifier: Apache-2.0
// The commands on a running subsystem, one row each: the words of a command, what it asks of the control protocol, and
// how the answer is shown. docs/howto/add-a-command.md says how to add one.
#pragma once

#include <cstdio>
#include <span>
#include <string>

#include "chimera/cli/command/command.h"
#include "chimera/cli/live/session.h"
#include "chimera/text/json.h"

namespace chimera::cli {

/// The help of --subsystem.
inline constexpr const char* kWhichOne =
    "name of the subsystem; needed to act on one that was started in another terminal and folder";

/// The screen that shows the result of a command.
struct Screen {
  std::size_t width = 0;     ///< in columns; 0: it is no terminal
  std::size_t height = 24;   ///< in lines
  std::FILE* err = nullptr;  ///< gets a line about what a command waits for; null: no line is written
};

/// A row of the table of commands. It works by `method` with `parameters` and `show`, or by `once`, or by `live`. Plain
/// value.
struct RunningCommand {
  Command words;
  const char* method = nullptr;  ///< what it asks of the control protocol; nullptr: nothing
  /// The parameters of that request; nullptr: none.
  Json (*parameters)(const Call&) = nullptr;
  /// The answer as text for people.
  std::string (*show)(const Json& answer) = nullptr;
  /// In the place of `parameters` and `show`, for a command of more than one request.
  CommandResult (*once)(Session&, const Call&, const Screen&) = nullptr;
  /// Prints until the user ends it; returns the exit code.
  int (*live)(Session&, const Call&, std::FILE* out, std::FILE* err) = nullptr;
  const char* live_option = nullptr;  ///< `live` only with this option; nullptr: always
  /// Called if no subsystem runs whose name is the operand; nullptr: the command is refused.
  CommandResult (*without)(const Call&, const std::string& subsystem, const Error& why) = nullptr;
  bool names_its_subsystem = false;   ///< its answer for people begins with the name of the subsystem

  bool is_live(const Call& call) const { return live != nullptr && (live_option == nullptr || call.has(live_option)); }
};

/// In the order of the alphabet. Context of all: setup.
std::span<const RunningCommand> running_commands();
/// The words `help` and `quit`, which the shell carries out itself.
const Command& help_words();
const Command& quit_words();
/// The words of all of these.
Table shell_words();
/// The row that `call` was read by.
const RunningCommand& row_of(const Call& call);

/// Asks once and shows the answer, or the refusal; what goes on is asked for once, too. May block.
CommandResult one_shot(Session& session, const Call& call, const Screen& screen);

}  // namespace chimera::cli
