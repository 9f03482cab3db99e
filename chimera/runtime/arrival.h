// SPDX-License-Identifier: Apache-2.0
// What holds a switch up before a task may go ON: what `safe_when` asks, other constants.
#pragma once

#include <span>

#include "chimera/runtime/idle_gap.h"
#include "chimera/runtime/job_threads.h"
#include "chimera/runtime/members.h"
#include "chimera/runtime/safe_condition.h"
#include "chimera/runtime/switch_page.h"
#include "chimera/runtime/switch_plan.h"
#include "chimera/runtime/task_set.h"

namespace chimera {

/// True also where nothing is asked. Context: cycle boundary; no allocation.
bool holds(TaskSet& set, const SafeCondition& asked) noexcept;

/// What became of a task that arrives in a fast switch and may have been initialised with other constants than those of
/// the set after.
enum class Followed : std::uint8_t { kNothing, kNoGap, kDone, kFailed };

/// Re-initialises the task in a gap where that is so. Context: cycle boundary; as long as its `reinit` takes.
Followed follow_constants(TaskSet& set, const IdleGap& gap, Task& task, const SwitchOrder& order,
                          Nanoseconds now) noexcept;

/// Hot standbys of this context that arrive are turned OFF first, and armed as any task. False: one has a job under
/// way; later. Context: cycle boundary; as long as `off` takes.
bool cool_down(TaskSet& set, JobThreads& threads, Members& members, const SwitchPlan& plan, Nanoseconds now) noexcept;

}  // namespace chimera
