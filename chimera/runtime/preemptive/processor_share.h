// SPDX-License-Identifier: Apache-2.0
// Recent use of the processor by the jobs of a context, and the tasks to demote first when it comes near the share that
// the kernel grants all real-time threads together: beyond it the kernel takes the processor from every one of them.
// Bookkeeping only. docs/design/preemptive.md
#pragma once

#include <span>
#include <vector>

#include "chimera/base/ids.h"
#include "chimera/schedule/policy.h"
#include "chimera/schedule/recent_use.h"
#include "chimera/task/task.h"

namespace chimera {

/// In the section. Context: cycle; wait-free; no allocation.
class ProcessorShare {
 public:
  /// Jobs may use `share` of each `window`; kNever: no limit.
  struct Limit {
    Nanoseconds share = kNever, window;
  };

  /// Less important are the tasks of a lower criticality than the highest (maximum urgency first), or those of the
  /// longest period (rate monotonic); deadlines do not decide it. For tasks with `is_mine`. Context: setup.
  ProcessorShare(std::span<const Task> tasks, const std::vector<bool>& is_mine, Policy policy, const Limit& limit);

  bool is_limited() const noexcept { return limit_.share != kNever; }
  /// From `now` on a job of `task` has the processor; invalid: no job has. Nothing is counted without a limit.
  void set_running(TaskId task, Nanoseconds now) noexcept;
  /// Time used by all jobs within the window.
  Nanoseconds used(Nanoseconds now) noexcept { return use_.used(now); }

  /// Time left for less important tasks: the share less the need of the others (their budgets, or their use if it is
  /// more). Not above zero: one less important task must be demoted. Requires: is_limited().
  Nanoseconds left(Nanoseconds now) noexcept;
  /// True if a job of the task may be demoted at `now`, when nothing is left. A less important one always. Any other
  /// one only if all together have used up the share: one that is over its budget, and all but the most urgent job.
  bool may_demote(TaskId task, bool is_over_budget, bool is_most_urgent, Nanoseconds now) noexcept;

  /// A job of the task has been demoted; true if that is to be reported, once a second at most.
  bool note_demoted(TaskId task, Nanoseconds now) noexcept;
  /// The task to be reported, once; invalid: none.
  TaskId pop_demoted() noexcept;

 private:
  Limit limit_;
  std::vector<bool> is_less_important_;  // by task
  Nanoseconds kept_for_important_;       // of the share
  RecentUse use_, use_by_less_;          // by all jobs; by those of less important tasks
  TaskId demoted_;                       // to be reported
  Nanoseconds reported_at_;
};

}  // namespace chimera
