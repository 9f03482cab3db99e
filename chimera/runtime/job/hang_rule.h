// SPDX-License-Identifier: Apache-2.0
// The rule by which every executor gives up a job that does not end by itself.
#pragma once

#include <algorithm>

#include "chimera/task/task_spec.h"

namespace chimera {

/// The most execution time of a job: ten times its budget (without one: its period), at least three periods and 5 ms.
/// So stolen time and a cold cache are no reason to end an rtpu. Context: any; pure.
constexpr Nanoseconds most_use(const TaskSpec& task) noexcept {
  const Nanoseconds stated = task.budget > Nanoseconds{} ? task.budget : task.period;
  return std::max({stated * 10, task.period * 3, milliseconds(5)});
}

/// True if a job that has used `used` and waited for `slept` without need does not end by itself: it used more than
/// most_use(), or waits for 2 s and ten periods. Context: any; pure.
constexpr bool hangs(const TaskSpec& task, Nanoseconds used, Nanoseconds slept) noexcept {
  return used > most_use(task) || slept > std::max(seconds(2), task.period * 10);
}

}  // namespace chimera
