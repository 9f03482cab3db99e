// SPDX-License-Identifier: Apache-2.0
// The whole manager: driver, backend and door in one loop.
#pragma once

#include "chimera/manager/manager_loop.h"

namespace chimera::manager {

/// Runs until the keeper is gone; answers the exit code. Refuses what ManagerLoop::start refuses. Blocks.
Result<int> run(const Inherited& inherited, std::uint32_t incarnation, std::int32_t keeper_pid);

}  // namespace chimera::manager
