// SPDX-License-Identifier: Apache-2.0
// The order in which everything is turned OFF and killed at the end: docs/formats/processes.md, "Ending".
#pragma once

#include <vector>

#include "chimera/runtime/application_spec.h"

namespace chimera {

/// Every task once: reverse data-flow order, tasks with hardware last. Context: setup.
std::vector<TaskId> ending_order(const ApplicationSpec& spec);

}  // namespace chimera
