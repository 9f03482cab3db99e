// SPDX-License-Identifier: Apache-2.0
// The orders in which all tasks go ON and end, computed once, by verification: every process reads them from the spec.
#pragma once

#include <vector>

#include "chimera/runtime/application_spec.h"

namespace chimera {

/// Every task once: the start set in its own order; around it hardware first, producers before their consumers, loops
/// cut at the first task by declaration. Requires: spec.variables and spec.start. Context: setup.
std::vector<TaskId> make_on_order(const ApplicationSpec& spec);

/// Every task once: spec.on_order backwards, tasks with hardware last, so that all tasks that command a device are OFF
/// before it. Context: setup.
std::vector<TaskId> make_end_order(const ApplicationSpec& spec);

}  // namespace chimera
