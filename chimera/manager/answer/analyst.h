// SPDX-License-Identifier: Apache-2.0
// The process that answers questions about descriptions for the manager. It may take long, use much memory, or die.
#pragma once

#include "chimera/base/result.h"

namespace chimera::manager {

/// Descriptors that the manager passes to it: its channel and the bundle.
inline constexpr int kAnalystDescriptors[] = {3, 4};

/// Answers questions until the manager is gone or closes the channel; returns the exit code. Refuses a damaged bundle.
/// Blocks.
Result<int> run_analyst(int channel, int bundle);

}  // namespace chimera::manager
