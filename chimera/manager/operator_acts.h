// SPDX-License-Identifier: Apache-2.0
// What faces may do beside signals: set operator variables, raise the operator's flag, ask for tuned values in
// the words of a description.
#pragma once

#include <string>
#include <variant>
#include <vector>

#include "chimera/control/rpc_response.h"
#include "chimera/manager/manager_state.h"
#include "chimera/text/json.h"

namespace chimera::manager {

/// Context of all: setup.
/// The variables of these names, each once, none: all of them; refuses an unknown one with the nearest.
std::variant<std::vector<VariableId>, control::RpcResponse> variables_named(const ManagerState& world,
                                                                            const std::vector<std::string>& names);
/// The tasks of these names; refuses none at all, and an unknown one with the nearest.
std::variant<std::vector<TaskId>, control::RpcResponse> tasks_named(const ManagerState& world,
                                                                    const std::vector<std::string>& names);
/// Why nobody would answer a ring of the task's doorbell; good when it is behind a server and ON.
control::RpcResponse judge_ring(const ManagerState& world, TaskId task);
/// {name: value}: sets operator variables, all or none. The answer has their readings.
control::RpcResponse set_values(ManagerState& world, const Json& values);
/// Raises or lowers the operator's part of the flag.
control::RpcResponse set_flag(ManagerState& world, bool up);
/// Present values of the operator variables in the words of a description.
control::RpcResponse saved_values(const ManagerState& world);

}  // namespace chimera::manager
