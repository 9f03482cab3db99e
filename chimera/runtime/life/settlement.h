// SPDX-License-Identifier: Apache-2.0
// Handles the results of jobs that others must see, between jobs: faults and notes, signals sent, the flag, the
// reactions stop and switch, a state that is no longer ON, causes of missed deadlines.
#pragma once

#include <span>

#include "chimera/runtime/job/job_record.h"
#include "chimera/runtime/job/miss_policy.h"
#include "chimera/runtime/life/boundary_listener.h"
#include "chimera/runtime/life/members.h"
#include "chimera/runtime/life/task_set.h"
#include "chimera/runtime/record/context_tap.h"

namespace chimera {

/// Context of everything: cycle boundary; no allocation. By the thread that handles cycle boundaries.
class Settlement {
 public:
  /// The parts of a settlement; all of them outlive it. The cause and the listener: both or neither.
  struct Parts {
    TaskSet& set;
    std::span<JobRecord> records;
    ContextTap& tap;
    Members& members;
    MissPolicy& misses;
    MissCause* cause;
    BoundaryListener* guest;
  };
  explicit Settlement(const Parts& parts) noexcept : parts_(parts) {}

  bool is_unsettled(TaskId task) const noexcept {
    return parts_.records[task.index].left.load(std::memory_order_relaxed) != 0;
  }
  /// Handles everything that jobs of the task left. Requires: no job is under way.
  void settle_job(TaskId task, Nanoseconds now) noexcept;
  /// Handles only work that does not wait for the end of a job: the flag, stop, the cause of a missed deadline.
  void settle_at_once(TaskId task, Nanoseconds now) noexcept;
  /// settle_at_once() at `now` reports a missed deadline of the task with its cause. Wait-free.
  bool has_unreported_miss(TaskId task, Nanoseconds now) const noexcept {
    const std::uint8_t left = parts_.records[task.index].left.load(std::memory_order_relaxed);
    return (left & JobRecord::kFindCause) != 0 && parts_.cause->may_judge(task, now);
  }
  /// Ends tasks that missed too many deadlines because others never let them start: no job of theirs would do it.
  void give_up_starved(Nanoseconds now) noexcept;
  /// Reports a new fault or note of the task.
  void record_faults(Task& task) noexcept;
  /// The reaction on_fault, once when the task has gone to ERROR.
  void follow_error(Task& task, Nanoseconds now) noexcept;

  /// One of the reactions error, flag, stop and switch of on_fault.
  void react_to_fault(Task& task, OnFault reaction, Nanoseconds now) noexcept;

  /// Publishes the changes, if there are any.
  void publish() noexcept;

  bool task_stopped() const noexcept { return task_stopped_; }
  /// The first task whose reaction was `stop`. Requires: task_stopped().
  TaskId stopped_by() const noexcept { return stopped_by_; }
  /// The reaction `stop` has been answered: the run may go on.
  void forget_stop() noexcept { task_stopped_ = false; }

 private:
  void settle(Task& task, Nanoseconds now) noexcept;
  void raise_flag(TaskId by, State in, Nanoseconds at) noexcept;
  void stop(TaskId by) noexcept;

  Parts parts_;
  bool task_stopped_ = false;
  TaskId stopped_by_;
};

}  // namespace chimera
