// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "chimera/task/task_spec.h"

namespace chimera {

/// Share of a processor that real-time work may use: Linux throttles real-time threads above 0.95.
inline constexpr double kMaxUtilisation = 0.93;

/// Before the kernel's own limit, by so much, jobs give way: it counts more than their executor sees of them.
inline constexpr double kShareMargin = 0.005;

/// What a task may use of a processor: its budget, or the capacity of its server, over the period; 0 without a budget.
/// Context: setup; pure.
constexpr double load_of(const TaskSpec& task) noexcept {
  const Nanoseconds time = task.server ? task.server->capacity : task.budget;
  return static_cast<double>(time.count) / static_cast<double>(task.period.count);
}

/// Whether shares of a processor that add up to `sum` are more than `limit`; how they are rounded does not count.
/// Context: setup; pure.
constexpr bool is_beyond(double sum, double limit = kMaxUtilisation) noexcept { return sum > limit + 1e-9; }

}  // namespace chimera
