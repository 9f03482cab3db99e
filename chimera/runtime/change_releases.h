// SPDX-License-Identifier: Apache-2.0
// What becomes of releases at the instant at which bindings change: those before it belong to the time before.
#pragma once

#include "chimera/runtime/job_threads.h"
#include "chimera/runtime/miss_policy.h"
#include "chimera/runtime/task_set.h"
#include "chimera/schedule/ready_queue.h"

namespace chimera {

/// Releases what was due before `instant`. Tasks that have threads take their releases themselves: no effect. Context:
/// cycle boundary; O(tasks); no allocation.
void release_before(ReadyQueue& queue, JobThreads& threads, MissPolicy& misses, Nanoseconds instant) noexcept;

/// The same at the instant `at` of a change, and drops the jobs of before that the next release of their task has
/// replaced by `now`: with the bindings of before they would run in the time after. Context: cycle boundary; O(tasks);
/// no allocation.
void change_releases(TaskSet& set, ReadyQueue& queue, JobThreads& threads, MissPolicy& misses, Nanoseconds at,
                     Nanoseconds now) noexcept;

}  // namespace chimera
