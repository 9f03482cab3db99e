// SPDX-License-Identifier: Apache-2.0
// What became of a signal, in the words of the control protocol.
#pragma once

#include <string>

#include "chimera/control/rpc_response.h"
#include "chimera/manager/manager_state.h"

namespace chimera::manager {

/// Context of both: setup.
/// The states of the tasks before and after, or the refusal with its kind, place and remedy.
control::RpcResponse signal_answer(const ManagerState& world, const subsystem::CommandAnswer& answer);
/// Error -32006 with what the real-time unit runs.
control::RpcResponse no_answer(const ManagerState& world, RtpuId rtpu, const std::string& text);

}  // namespace chimera::manager
