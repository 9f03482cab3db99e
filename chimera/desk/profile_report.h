// SPDX-License-Identifier: Apache-2.0
// The profile of every task, as a table for people and as JSON: what it costs and how punctual it is.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "chimera/runtime/task_set.h"

namespace chimera::desk {

/// The state of every task, in order: taken at the end of a run, before everything is shut down.
std::vector<State> states_of(const TaskSet& tasks);

/// One line a task: state (as in `states`), cycles, execution time of cycle (mean, max), load, response, start jitter,
/// failures; then a line for every task with a fault. `ran` is the time that the loads refer to; faults are timed from
/// `origin`. Context: setup.
std::string profile_table(const TaskSet& tasks, std::span<const State> states, Nanoseconds ran, Nanoseconds origin);
/// A JSON array with everything counted, times in nanoseconds, of faults from `origin`. Context: setup.
std::string profile_json(const TaskSet& tasks, std::span<const State> states, Nanoseconds origin);

}  // namespace chimera::desk
