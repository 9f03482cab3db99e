// SPDX-License-Identifier: Apache-2.0
// A joining component between a variable and several producers of it (1994 paper, figure 3).
#pragma once

#include "chimera/base/result.h"
#include "chimera/description/edit_act.h"
#include "chimera/description/node.h"

namespace chimera {

/// Each producer gets a variable of its own, VARIABLE_1 and so on, and a new task JOIN makes VARIABLE of them, in each
/// configuration with one of the producers. Refuses: fewer than two producers, more than 16, a task that is not there.
/// Context: setup.
Result<void> join_producers(Node& root, const JoinProducers& act);

}  // namespace chimera
