// SPDX-License-Identifier: Apache-2.0
// Commands for a person to type after a refused signal or a given-up rtpu. They are legal in the present state.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "chimera/subsystem/subsystem_state.h"

namespace chimera::subsystem {

/// "`chimera clear pi`, then `chimera on setpoint pi`". The commands carry out the signal for every task for which it
/// can be. They name no task that is already in the wanted state; "" if no task needs one. Context of all functions:
/// setup.
std::string remedy(const SubsystemState& subsystem, Signal signal, std::span<const TaskId> tasks);
/// Commands for tasks that were lost with their process. After them, the tasks in `were_on` are ON again.
std::string way_back(const SubsystemState& subsystem, std::span<const TaskId> lost, std::span<const TaskId> were_on);
/// Commands for tasks that do not exist yet: `chimera spawn`.
std::string spawning(const SubsystemState& subsystem, std::span<const TaskId> absent);
/// The commands as the remedy of a refusal: "type `chimera clear pi`"; "" if there are none.
inline std::string typed(const std::string& commands) { return commands.empty() ? "" : "type " + commands; }

}  // namespace chimera::subsystem
