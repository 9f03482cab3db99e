// SPDX-License-Identifier: Apache-2.0
// The number that a SafeCondition compares, read from the context that produces it.
#pragma once

#include "chimera/runtime/life/task_set.h"
#include "chimera/runtime/safe_condition.h"

namespace chimera {

/// The present value that the condition compares. NaN: no task that is ON produces the variable, it never had a value,
/// or has no such element. Requires: condition.is_there(). Context: cycle boundary; no allocation.
double present_value(TaskSet& set, const SafeCondition& condition) noexcept;

}  // namespace chimera
