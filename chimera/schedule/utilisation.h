// SPDX-License-Identifier: Apache-2.0
// The first admission: does the work that the tasks state fit their processors at all?
// Necessary for every policy; sufficient for preemptive earliest deadline with deadline = period
// (Liu & Layland 1973). Response times and demand are other questions.
#pragma once

#include <cstdint>
#include <span>

#include "chimera/base/ids.h"
#include "chimera/base/result.h"
#include "chimera/task/task_spec.h"

namespace chimera {

/// Share of a processor that real-time work may use: Linux throttles real-time threads above 0.95.
inline constexpr double kMaxUtilisation = 0.93;

/// What the ON set states about one processor.
struct Utilisation {
  std::uint32_t cpu = 0;
  double sum = 0;              ///< of budget / period over the tasks that state a budget
  std::uint32_t unstated = 0;  ///< tasks without a budget: they count nothing
  TaskId largest;              ///< the task with the largest share; invalid when none states a budget
};

/// Adds up the tasks `on` that run on `cpu`. `cpu_of` is the processor of each rtpu, by RtpuId.
/// Context: setup; pure.
Utilisation utilisation(std::span<const TaskSpec> tasks, std::span<const TaskId> on,
                        std::span<const std::uint32_t> cpu_of, std::uint32_t cpu) noexcept;

/// Refuses (kRefused, place "cpu N") when some processor is asked for more than kMaxUtilisation, naming by how
/// much, the task with the largest share, and the budget with which that task would fit, if any would.
/// Context: setup; pure.
Result<void> admit(std::span<const TaskSpec> tasks, std::span<const TaskId> on,
                   std::span<const std::uint32_t> cpu_of) noexcept;

}  // namespace chimera
