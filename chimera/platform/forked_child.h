// SPDX-License-Identifier: Apache-2.0
// A copy of this process that does one piece of work, prints nothing, and ends.
#pragma once

#include <sys/types.h>

#include <functional>
#include <string>

#include "chimera/base/result.h"

namespace chimera {

/// Forks a child that runs `work` with its standard streams on /dev/null and in the folder `folder` ("": that of its
/// parent), and ends with what `work` returned as exit status, 1 where the folder cannot be entered. Nothing of the
/// parent's is flushed or destroyed by the child. The number of the child, for watch_child(); refuses with the
/// system's reason. Context: setup.
Result<pid_t> fork_quietly(const std::string& folder, const std::function<int()>& work);

}  // namespace chimera
