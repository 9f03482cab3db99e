// SPDX-License-Identifier: Apache-2.0
// The change of one context at the instant T of a switch: states of tasks, their inputs, and releases. Other contexts
// see one step. A job that was released before T ends with its old inputs and outputs.
#pragma once

#include "chimera/runtime/job/job_threads.h"
#include "chimera/runtime/job/miss_policy.h"
#include "chimera/runtime/life/members.h"
#include "chimera/runtime/life/task_set.h"
#include "chimera/runtime/plan/switch_plan.h"
#include "chimera/runtime/record/context_tap.h"
#include "chimera/schedule/ready_queue.h"

namespace chimera {

/// Context of everything not marked: cycle boundary; O(tasks + links); no allocation.
class Changeover {
 public:
  /// All given outlive this.
  Changeover(TaskSet& set, ReadyQueue& queue, JobThreads& threads, Members& members, MissPolicy& misses,
             ContextTap& tap) noexcept
      : set_(set), queue_(queue), threads_(threads), members_(members), misses_(misses), tap_(tap) {}
  /// Context: setup.
  void prepare() { has_old_job_ = set_.setup_memory().take<bool>(set_.tasks().size()); }

  /// Releases what was due before `instant`, so that those jobs keep the old bindings.
  void release_before(Nanoseconds instant) noexcept;
  /// Applies the instant `at` of the change to releases. A job that was released before `at` keeps the old bindings. If
  /// its task has been released again by `now`, the old job is dropped: it would run after `at` with the old bindings.
  void change_releases(Nanoseconds at, Nanoseconds now) noexcept;
  /// From now on changes of other contexts to the tasks of the plan have no effect here: `before` are ON. No task of
  /// this context takes a release at `at` or later before its change.
  void hold(const SwitchPlan& plan, const TaskBits& before, Nanoseconds at) noexcept;
  /// The change, at `at`. Requires: hold(); all releases before `at` have been taken, and no later one.
  void make(const SwitchPlan& plan, const TaskBits& after, Nanoseconds at) noexcept;
  /// Lets tasks change whose jobs released before `at` have ended since. True: all have changed.
  bool follow(const SwitchPlan& plan, Nanoseconds at) noexcept;
  /// Other contexts count again as they are: all have changed, or the plan was aborted.
  void release() noexcept;

 private:
  void leave(Task& task, Nanoseconds at) noexcept;

  TaskSet& set_;
  ReadyQueue& queue_;
  JobThreads& threads_;
  Members& members_;
  MissPolicy& misses_;
  ContextTap& tap_;
  TaskBits bits_;                // what the set is judged as
  std::span<bool> has_old_job_;  // by task
};

}  // namespace chimera
