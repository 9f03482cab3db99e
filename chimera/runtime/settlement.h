// SPDX-License-Identifier: Apache-2.0
// What jobs left for others to see, dealt with between jobs: faults and notes, signals sent, the flag, the reactions
// stop and switch, a state that is ON no more, causes of missed deadlines.
#pragma once

#include <span>

#include "chimera/runtime/boundary_listener.h"
#include "chimera/runtime/context_tap.h"
#include "chimera/runtime/job_record.h"
#include "chimera/runtime/members.h"
#include "chimera/runtime/miss_policy.h"
#include "chimera/runtime/task_set.h"

namespace chimera {

/// Context of everything: edge; no allocation. By the thread that takes the edges.
class Settlement {
 public:
  /// What a settlement works on; all of it outlives the settlement. `cause` and `guest`: both or neither.
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
  /// Everything that jobs of the task left. Requires: none is under way.
  void settle_job(TaskId task, Nanoseconds now) noexcept;
  /// Only what does not wait for the end of a job: the flag, stop, the cause of a missed deadline.
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

  /// Has what changed published, if anything did.
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
