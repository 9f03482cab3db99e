// SPDX-License-Identifier: Apache-2.0
// What the guard did, as events: docs/formats/processes.md, "The guard".
#pragma once

#include "chimera/manager/manager_state.h"
#include "chimera/rtpu/keeper_message.h"

namespace chimera::manager {

/// Events of the kind `safe` for kFramesWritten, kSilent and kGuardState; nothing for any other message.
/// Context: setup.
void tell_of_guard(ManagerState& world, const KeeperMessage& message, Nanoseconds now);

}  // namespace chimera::manager
