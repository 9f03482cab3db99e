// SPDX-License-Identifier: Apache-2.0
// The process beside the manager that answers questions about descriptions: it may take its time, need memory, or die.
#pragma once

#include "chimera/base/result.h"

namespace chimera::manager {

/// Descriptors that the manager hands over: its channel and the bundle.
inline constexpr int kAnalystDescriptors[] = {3, 4};

/// Answers until the manager is gone or wants nothing more; answers the exit code. Refuses a bundle that is none.
/// Blocks.
Result<int> run_analyst(int channel, int bundle);

}  // namespace chimera::manager
