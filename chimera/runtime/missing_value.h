// SPDX-License-Identifier: Apache-2.0
// What a task would read that never had a value: it cannot begin before.
#pragma once

#include <span>

#include "chimera/runtime/switch_plan.h"
#include "chimera/runtime/task_set.h"

namespace chimera {

/// The first variable that the task, which is OFF, reads and that never had a value; invalid: there is none. What an
/// arriving task will write, by `handovers`, is not asked for. Context: edge; O(inputs).
VariableId missing_value(TaskSet& set, Task& task, std::span<const Handover> handovers) noexcept;

}  // namespace chimera
