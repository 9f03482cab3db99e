// SPDX-License-Identifier: Apache-2.0
// The profile of every task as a table for people: what it costs and how punctual it is.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "chimera/analysis/task_profile.h"
#include "chimera/runtime/life/task_set.h"

namespace chimera::cli {

/// The profiles of all tasks of an application in one process, in order, at `now`; `states`: those before the shutdown.
std::vector<TaskProfile> profiles_of(std::span<const Task* const> tasks, std::span<const State> states,
                                     const Configuration& configuration, Nanoseconds now);

/// One line a task: state, cycles, execution time of cycle (mean, max), load, response, start jitter, failures; then a
/// line for every task that was preempted or demoted or had events, and one for every task with a fault. `ran` is the
/// time that the loads refer to; faults are timed from `origin`. Context: setup.
std::string profile_table(std::span<const TaskProfile> tasks, Nanoseconds ran, Nanoseconds origin);

}  // namespace chimera::cli
