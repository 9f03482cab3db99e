// SPDX-License-Identifier: Apache-2.0
// Names the tasks and rtpus that hold up the start of a subsystem, as far as they are known.
#pragma once

#include <string>

#include "chimera/text/json.h"

namespace chimera::cli {

/// "log (csv_log): its `init` is under way", from the answer of `status`; a sentence also when no task stands out.
/// Context: setup.
std::string not_ready(const Json& status);

}  // namespace chimera::cli
