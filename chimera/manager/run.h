// SPDX-License-Identifier: Apache-2.0
// The whole manager: ManagerLoop, ManagerBackend and ControlServer in one thread.
#pragma once

#include "chimera/manager/manager_loop.h"

namespace chimera::manager {

/// Runs until the keeper is gone; returns the exit code. Refuses if ManagerLoop::start refuses. Blocks.
Result<int> run(const Inherited& inherited, std::uint32_t incarnation, std::int32_t keeper_pid);

}  // namespace chimera::manager
