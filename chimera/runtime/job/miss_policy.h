// SPDX-License-Identifier: Apache-2.0
// The failures of time of jobs, and the reactions to them.
//
// The three failures of time (Stewart & Khosla; docs/decisions/0003-releases-and-late-jobs.md) and what they see:
//   missed deadline    the job was not over at its deadline                                  on_miss
//   budget exceeded    it used more execution time than its budget                           on_overrun
//   minimum refused    at its start less than `min` was left before the deadline             on_miss
// Reactions: continue (a late result is published), hold (not published), skip (published; the next release is
// dropped), switch (published; a configuration is asked for), abort (the job is over at its deadline: not started after
// it, nothing published; in preemptive virtual time abandoned at that instant), error (the method error is called,
// nothing published), flag (published; the illegal-configuration flag goes up and stays up until it is lowered), stop
// (published; the executor stops), demote (from then on the job runs below all others; published).
// A refused minimum: continue, flag and switch run the job all the same, the others do not start it.
//
// A job with a thread of its own is looked at when its deadline comes, and when its budget is used up: the cause is
// reported then, and flag and stop act then. Else the job's end does that, as it does the rest in any case
// (docs/decisions/0003-releases-and-late-jobs.md).
//
// A release that is dropped because jobs took too long is a missed deadline as well, in Profile::missed and towards
// max_consecutive; one that a reaction drops on purpose is not.
#pragma once

#include <cstdint>
#include <span>

#include "chimera/base/mechanisms.h"
#include "chimera/runtime/job/job_clock.h"
#include "chimera/runtime/job/job_record.h"
#include "chimera/runtime/job/job_step.h"
#include "chimera/runtime/job/miss_cause.h"
#include "chimera/runtime/record/context_tap.h"
#include "chimera/schedule/ready_queue.h"

namespace chimera {

/// Judges jobs that fail in time, one thread at a time for each task. Work that it leaves for cycle boundaries
/// stands in JobRecord::left. Context of everything not marked: cycle, on the task's own thread; wait-free but for the
/// method error of a component.
class MissPolicy {
 public:
  /// `cause` null: causes are not looked for. Everything given outlives this. Context: setup.
  MissPolicy(std::span<Task> tasks, std::span<JobRecord> records, ContextTap& tap, MissCause* cause,
             JobClock& clock) noexcept
      : tasks_(tasks), records_(records), tap_(tap), cause_(cause), clock_(clock) {}

  /// For a job that JobCycle::can_start() did not simply let start: the release is to be skipped, or less than the
  /// minimum time is left. False: the job must not start; its release is then counted as dropped.
  bool decide_start(const Job& job, Nanoseconds now) noexcept;
  /// From here on nothing is reported of the task's present job before its end; the JobRecord::Report bits that were.
  std::uint8_t end_reports(TaskId task) noexcept;
  /// The job ended late, or beyond its budget, at `end`: counts that and reacts. False when its result must not be
  /// published; `body` is changed by the reactions abort and error. `reported`: of end_reports().
  bool judge(const Job& job, BodyEnd& body, Nanoseconds end, Nanoseconds used, std::uint8_t reported) noexcept;
  /// A job of the task ended in time and within its budget.
  void count_good(Task& task) noexcept;
  /// The job began and is abandoned at its deadline (reaction abort): counts the miss; the end of the job follows.
  void abandon(const Job& job) noexcept;
  /// The job never started and its deadline has come (reaction abort).
  void expire_unstarted(const Job& job) noexcept;
  /// Releases of the task that will not run for lack of time.
  void drop(const DroppedRelease& dropped) noexcept;

  /// A job of the task is released of which nothing was reported yet. Call it before any other thread knows of the job.
  void forget_reports(TaskId task) noexcept { records_[task.index].reported.store(0, std::memory_order_relaxed); }
  /// The deadline of the job has come and it is not over. The cause is reported, and where the job has begun `flag`
  /// and `stop` act, unless the miss is tolerated; its end counts the miss. Once a job. Context: cycle boundary.
  void report_late(const Job& job, bool has_begun) noexcept;
  /// The job of the task that is under way, its `cycle`-th, has used more than its budget: `flag` and `stop` act. False
  /// when that was reported before. Context: cycle boundary.
  bool report_overrun(TaskId task, std::uint64_t cycle, Nanoseconds used, Nanoseconds now) noexcept;
  bool is_reported_late(TaskId task) const noexcept { return was_reported(task, JobRecord::kLate); }
  bool is_reported_overrun(TaskId task) const noexcept { return was_reported(task, JobRecord::kOverrun); }

  /// The task missed as many deadlines in a row as max_consecutive allows.
  static bool is_out_of_patience(const Task& task) noexcept {
    const std::uint32_t limit = mechanisms::kReactions ? task.spec->max_consecutive : 0;
    return limit > 0 && task.profile.missed_in_a_row >= limit;
  }
  /// Ends the task for that, in ERROR.
  void give_up(Task& task, Nanoseconds at) noexcept;
  /// A dropped release made some task's misses too many since clear_lost_patience(). Context: cycle boundary.
  bool has_lost_patience() const noexcept { return patience_lost_; }
  void clear_lost_patience() noexcept { patience_lost_ = false; }

 private:
  bool was_reported(TaskId task, int what) const noexcept {
    return (records_[task.index].reported.load(std::memory_order_relaxed) & what) != 0;
  }
  bool report_once(TaskId task, JobRecord::Report what) noexcept;
  void leave(TaskId task, JobRecord::Left what) noexcept {
    records_[task.index].left.fetch_or(what, std::memory_order_relaxed);
  }
  void leave_reaction(TaskId task, OnMiss reaction, JobRecord::Left on_switch) noexcept;
  void leave_cause(TaskId task, Nanoseconds release) noexcept;
  void count_miss(Task& task, Nanoseconds at, Nanoseconds lateness) noexcept;
  void drop_on_purpose(const DroppedRelease& dropped) noexcept;
  bool react(OnMiss reaction, JobRecord::Left on_switch, Task& task, BodyEnd& body, Nanoseconds at) noexcept;

  std::span<Task> tasks_;
  std::span<JobRecord> records_;
  ContextTap& tap_;
  MissCause* cause_;
  JobClock& clock_;
  bool patience_lost_ = false;
};

}  // namespace chimera
