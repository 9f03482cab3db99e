// SPDX-License-Identifier: Apache-2.0
// What a person types when a signal was refused or a real-time unit was given up: commands that work as things stand.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "chimera/subsystem/subsystem_state.h"

namespace chimera::subsystem {

/// "`chimera clear pi`, then `chimera on setpoint pi`": after it the signal has been carried out for as many of the
/// tasks as it can be. Names no task that is where the signal leads; "" when there is nothing to do. Context of all:
/// setup.
std::string remedy(const SubsystemState& subsystem, Signal signal, std::span<const TaskId> tasks);
/// The same for tasks that were lost with their process: those of `were_on` are ON again after it.
std::string way_back(const SubsystemState& subsystem, std::span<const TaskId> lost, std::span<const TaskId> were_on);
/// The same for tasks that are not there: `chimera spawn`.
std::string spawning(const SubsystemState& subsystem, std::span<const TaskId> absent);
/// "type `chimera clear pi`": the commands as the remedy of a refusal; "" when there are none.
inline std::string typed(const std::string& commands) { return commands.empty() ? "" : "type " + commands; }

}  // namespace chimera::subsystem
