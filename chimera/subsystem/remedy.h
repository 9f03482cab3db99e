// SPDX-License-Identifier: Apache-2.0
// What a person types when a signal was refused or a real-time unit was given up: commands that work as things stand.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "chimera/subsystem/situation.h"

namespace chimera::subsystem {

/// "`chimera clear pi`, then `chimera on setpoint pi`": after it the signal has been carried out for as many of the
/// tasks as it can be; "" when there is nothing to do. Context of all: setup.
std::string remedy(const Situation& situation, Signal signal, std::span<const TaskId> tasks);
/// The same for tasks that were lost with their process: those of `were_on` are ON again after it.
std::string way_back(const Situation& situation, std::span<const TaskId> lost, std::span<const TaskId> were_on);

}  // namespace chimera::subsystem
