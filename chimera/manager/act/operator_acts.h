// SPDX-License-Identifier: Apache-2.0
// Acts of clients besides signals: set operator variables, raise the operator's flag, and get tuned values in the words
// of a description.
#pragma once

#include <string>
#include <variant>
#include <vector>

#include "chimera/control/rpc_response.h"
#include "chimera/manager/state/manager_state.h"
#include "chimera/text/json.h"

namespace chimera::manager {

/// Context of all functions: setup.
/// The variables with these names, without repetition; all variables if there are no names. Refuses an unknown name and
/// suggests the nearest.
std::variant<std::vector<VariableId>, control::RpcResponse> variables_named(const ManagerState& state,
                                                                            const std::vector<std::string>& names);
/// The tasks with these names. Refuses an empty list; refuses an unknown name and suggests the nearest.
std::variant<std::vector<TaskId>, control::RpcResponse> tasks_named(const ManagerState& state,
                                                                    const std::vector<std::string>& names);
/// Reason why no task would answer a ring of the doorbell; good if the task has a doorbell and is ON.
control::RpcResponse judge_ring(const ManagerState& state, TaskId task);
/// {name: value}: sets operator variables, all or none. The answer contains their readings.
control::RpcResponse set_values(ManagerState& state, const Json& values);
/// Raises or lowers the operator's part of the flag.
control::RpcResponse set_flag(ManagerState& state, bool up);
/// Present values of the operator variables in the words of a description.
control::RpcResponse saved_values(const ManagerState& state);

}  // namespace chimera::manager
