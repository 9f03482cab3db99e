// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "chimera/task/task_spec.h"

namespace chimera {

/// Share of a processor that real-time work may use: Linux throttles real-time threads above 0.95.
inline constexpr double kMaxUtilisation = 0.93;

/// Jobs give way this much below the limit of the kernel, because the kernel counts more time than the executor
/// measures.
inline constexpr double kShareMargin = 0.005;

/// The load of a task: its budget, or the capacity of its server, divided by the period; 0 without a budget. Context:
/// setup; pure.
constexpr double load_of(const TaskSpec& task) noexcept {
  const Nanoseconds time = task.server ? task.server->capacity : task.budget;
  return static_cast<double>(time.count) / static_cast<double>(task.period.count);
}

/// True if shares of a processor with the sum `sum` exceed `limit`. Rounding errors are ignored. Context: setup; pure.
constexpr bool is_beyond(double sum, double limit = kMaxUtilisation) noexcept { return sum > limit + 1e-9; }

}  // namespace chimera
