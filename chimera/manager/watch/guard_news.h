// SPDX-License-Identifier: Apache-2.0
// The guard's reports as events: docs/formats/processes.md, "The guard".
#pragma once

#include "chimera/manager/state/manager_state.h"
#include "chimera/rtpu/keeper_message.h"

namespace chimera::manager {

/// Logs events of the kind `safe` for kFramesWritten, kSilent and kGuardState; ignores other messages. Context: setup.
void tell_of_guard(ManagerState& state, const KeeperMessage& message, Nanoseconds now);

}  // namespace chimera::manager
