// SPDX-License-Identifier: Apache-2.0
// The answers about the state of the subsystem: docs/formats/control.md, objects rtpu, task, profile, event.
#pragma once

#include <string>

#include "chimera/manager/state/manager_state.h"
#include "chimera/text/json.h"

namespace chimera::manager {

/// Context of all functions: setup; may block for the time of a copy.
Json status_json(const ManagerState& state, Nanoseconds at);
/// State of the illegal-configuration flag, and the tasks or persons that raised it.
Json flag_json(const ManagerState& state);
Json describe_json(const ManagerState& state);
Json profile_json(const ManagerState& state, Nanoseconds at);
Json event_json(const ManagerState& state, const LoggedEvent& event);
/// At most `limit` events from number `since` on.
Json events_json(const ManagerState& state, std::uint64_t since, std::size_t limit);
Json library_json(const ManagerState& state);
/// The last fault of a task as "cycle: its words"; "" if there was none.
std::string fault_text(const ManagerState& state, TaskId task);
/// "arming", "agreeing", "committed" or "aborted".
const char* phase_word(SwitchPhase phase);
/// Name of the configuration whose tasks are ON, exactly; "" if it has no name.
std::string configuration_name(const ManagerState& state);

}  // namespace chimera::manager
