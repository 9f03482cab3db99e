// SPDX-License-Identifier: Apache-2.0
// Makes the commands of a remedy: `spawn` for absent tasks, `clear` for tasks in ERROR, then the signal itself.
#include "chimera/subsystem/remedy.h"

#include "chimera/base/hosted/wording.h"

namespace chimera::subsystem {
namespace {

/// Adds the command `word` for the tasks, if there are any.
void add(std::vector<std::string>& commands, const SubsystemState& subsystem, const char* word,
         std::span<const TaskId> tasks) {
  if (tasks.empty()) return;
  std::string command = std::string("`chimera ") + word;
  for (const TaskId task : tasks) command += " " + subsystem.name(task);
  commands.push_back(command + "`");
}

std::string in_turn(const std::vector<std::string>& commands) { return join(commands, ", ", {}, ", then "); }

}  // namespace

std::string remedy(const SubsystemState& subsystem, Signal signal, std::span<const TaskId> tasks) {
  const bool needs_all = signal == Signal::kOn || signal == Signal::kReinit;
  std::vector<TaskId> spawn, clear, rest;
  for (const TaskId task : tasks) {
    const State state = subsystem.observed.state(task);
    const bool is_in_error = state == State::kError && signal != Signal::kKill;
    if (is_in_error)
      clear.push_back(task);
    else if (state == State::kNotCreated && (needs_all || signal == Signal::kSpawn || signal == Signal::kClear))
      spawn.push_back(task);
    // After the commands before, all other tasks are OFF. A task that is ON already needs no command.
    const State by_then = needs_all && state != State::kOn ? State::kOff : state;
    if (signal != Signal::kSpawn && signal != Signal::kClear && is_legal(by_then, signal)) rest.push_back(task);
  }
  std::vector<std::string> commands;
  add(commands, subsystem, "spawn", spawn);
  add(commands, subsystem, "clear", clear);
  add(commands, subsystem, signal_name(signal), rest);
  return in_turn(commands);
}

std::string way_back(const SubsystemState& subsystem, std::span<const TaskId> lost, std::span<const TaskId> were_on) {
  std::vector<std::string> commands;
  add(commands, subsystem, "clear", lost);
  add(commands, subsystem, "on", were_on);
  return in_turn(commands);
}

std::string spawning(const SubsystemState& subsystem, std::span<const TaskId> absent) {
  std::vector<std::string> commands;
  add(commands, subsystem, "spawn", absent);
  return in_turn(commands);
}

}  // namespace chimera::subsystem
