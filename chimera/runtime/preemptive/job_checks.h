// SPDX-License-Identifier: Apache-2.0
// Time of the next check of each job by the supervisor, and the one alarm that wakes it for that.
//
// A job that is alone in the ready list is checked up to kCoalesceWindow later than its check is due, when nothing has
// to act at that instant: one setting of the alarm then serves several jobs. A setting costs more than the rest of a
// release (it becomes the first timer of the CPU).
#pragma once

#include <vector>

#include "chimera/platform/wake.h"
#include "chimera/runtime/preemptive/job_thread.h"

namespace chimera {

/// In the section, unless said otherwise. Context: cycle; wait-free (arm: one system call; the ends of budget and
/// capacity: one, too); no allocation.
class JobChecks {
 public:
  /// How much later a job that is alone may be checked; the alarm is put off a little before that.
  static constexpr Nanoseconds kCoalesceWindow = microseconds(600), kPutOffMargin = microseconds(150);

  /// For tasks with indices below `n_tasks`. No job of a periodic task is late sooner than `shortest_deadline` after
  /// its release. Context: setup.
  JobChecks(std::size_t n_tasks, Nanoseconds shortest_deadline);

  /// Time of the check of the job; kNever: none.
  Nanoseconds due(const JobThread& job) const noexcept { return due_[job.id.index]; }
  /// The alarm is moved by rearm(), or comes in time anyhow.
  void set(const JobThread& job, Nanoseconds instant) noexcept { due_[job.id.index] = instant; }
  void clear(const JobThread& job) noexcept { set(job, kNever); }
  /// The alarm comes for the check as well; `n_ready` jobs are in the list, this one included.
  void watch(const JobThread& job, Nanoseconds instant, std::size_t n_ready) noexcept;

  /// After every job that was due has been checked: the alarm is set to `instant`.
  void rearm(Nanoseconds instant) noexcept;
  /// The alarm comes at `instant` at the latest.
  void arm_by(Nanoseconds instant) noexcept;
  /// No job is ready: what the alarm was set for is over, but for jobs that were demoted or halted. Moving the alarm
  /// now costs less than a check of the supervisor, and less than setting it at the next release, where a job waits.
  void put_off(Nanoseconds now) noexcept;
  /// When the alarm rings.
  Nanoseconds armed() const noexcept { return armed_; }

  /// When a job that has the processor will have used up its budget, where a reaction acts at that instant; else
  /// kNever. A job that has used nothing since the last look sleeps in a system call, and is looked at less often.
  /// `is_reported`: the job is known to have used its budget up.
  Nanoseconds end_of_budget(const JobThread& job, bool is_reported, Nanoseconds now) noexcept;
  /// When a job that has the processor will have used up the capacity of its server; kNever: it has none, or runs below
  /// all others.
  static Nanoseconds end_of_capacity(JobThread& job, Nanoseconds now) noexcept;
  /// True if the budget must be checked when it ends, and not at the end of the job.
  static bool acts_at_end_of_budget(const TaskSpec& spec) noexcept;

  /// Waits for the alarm. Context: the supervisor; outside the section; blocks.
  void wait() noexcept { alarm_.wait(); }
  /// The alarm rings at once. Context: setup.
  void ring() noexcept { alarm_.set({}); }

 private:
  static bool is_exact(const JobThread& job) noexcept;

  Alarm alarm_;
  Nanoseconds armed_ = kNever;
  Nanoseconds shortest_deadline_;
  std::vector<Nanoseconds> due_;      // by task
  std::vector<Nanoseconds> used_;     // by task: by the job at the last look for the end of its budget
  bool has_coalesced_ = false;        // some check of a ready job is due before the alarm rings
};

}  // namespace chimera
