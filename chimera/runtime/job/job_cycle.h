// SPDX-License-Identifier: Apache-2.0
// One job of a task: the decision to start, its beginning, its end. Equal for all executors, which differ only in who
// waits for releases and in how long a job takes.
#pragma once

#include <cstdint>
#include <span>

#include "chimera/base/mechanisms.h"
#include "chimera/runtime/job/job_record.h"
#include "chimera/runtime/job/job_step.h"
#include "chimera/runtime/job/miss_policy.h"
#include "chimera/runtime/record/context_tap.h"

namespace chimera {

/// Touches nothing but the task of the job, so that each task may have a thread of its own. Context of everything not
/// marked: cycle, on the thread that runs the job; as long as the component's methods take; no allocation, no system
/// call.
class JobCycle {
 public:
  /// `listens`: cycle boundaries report faults and notes, so that a job with a new one leaves kSettle. `is_tapped`: as
  /// tap.is_on(). All arguments outlive this. Context: setup.
  JobCycle(std::span<JobRecord> records, ContextTap& tap, MissPolicy& misses, MissCause* cause, JobClock& clock,
           bool listens) noexcept
      : records_(records), cause_(cause), is_tapped_(tap.is_on()), listens_(listens), tap_(tap), misses_(misses),
        clock_(clock) {}

  /// A job of the task is released, or about to begin: no cycle boundary touches the task before close(), and nothing
  /// was reported of the job yet. Context: the thread that hands the job out; wait-free.
  void open(TaskId task) noexcept { open(records_[task.index]); }
  /// No job of the task is under way any more. Context: as open().
  void close(TaskId task) noexcept { records_[task.index].task->is_busy = false; }

  /// The whole of may_start() for most jobs; false: ask MissPolicy::decide_start(). Wait-free.
  [[gnu::always_inline]] bool can_start(const Job& job, Nanoseconds now) noexcept {
    const JobRecord& record = records_[job.task.index];
    if (is_tapped_) tap_.record_release(job);
    return record.lets_start(now, job.deadline);
  }
  /// False if the job must not start. Its release is then counted as dropped, with all that follows.
  bool may_start(const Job& job, Nanoseconds now) noexcept {
    return can_start(job, now) || misses_.decide_start(job, now);
  }
  /// Runs the body: inputs are read at this moment, nothing is published. `time` is for the end. Requires: open().
  [[gnu::always_inline]] BodyEnd begin(const Job& job, CycleTime& time, bool illegal) noexcept {
    return begin(records_[job.task.index], job, time, illegal);
  }
  /// open() and begin() in one, for executors that run the job where they hand it out.
  [[gnu::always_inline]] BodyEnd open_and_begin(const Job& job, CycleTime& time, bool illegal) noexcept {
    JobRecord& record = records_[job.task.index];
    open(record);
    return begin(record, job, time, illegal);
  }
  /// The body of the job began at `start` and is over at `end`, having used `used` of execution time. Judges failures
  /// of time, publishes, handles errors. JobRecord::left lists the work left for others.
  void conclude(const Job& job, const CycleTime& time, BodyEnd body, Nanoseconds start, Nanoseconds end,
                Nanoseconds used) noexcept;
  /// close() and conclude() in one, for executors that run jobs in the thread of the cycle boundaries. True if
  /// JobRecord::left lists something to settle.
  [[gnu::always_inline]] bool close_and_conclude(const Job& job, const CycleTime& time, BodyEnd body,
                                                 Nanoseconds start, Nanoseconds end, Nanoseconds used) noexcept {
    JobRecord& record = records_[job.task.index];
    Task& task = *record.task;
    task.is_busy = false;
    const bool in_time = end <= job.deadline && record.is_within_budget(used);
    if (body.is_good() && in_time && record.is_plain && record.reported.load(std::memory_order_relaxed) == 0)
        [[likely]] {
      count_times(task, job, start, end, used);
      task.profile.missed_in_a_row = 0;
      cycle_step::publish(task, time, end);
      record.dropped -= time.dropped;  // this cycle has seen those
      if (task.has_news || task.is_tapped) [[unlikely]] look_after(task);
    } else {
      conclude(job, time, body, start, end, used);
    }
    return record.left.load(std::memory_order_relaxed) != 0;
  }

 private:
  static void open(JobRecord& record) noexcept {
    record.task->is_busy = true;
    record.reported.store(0, std::memory_order_relaxed);
  }
  [[gnu::always_inline]] static BodyEnd begin(JobRecord& record, const Job& job, CycleTime& time,
                                              bool illegal) noexcept {
    // Field by field: a copy of a fresh aggregate loads wider than it was stored, and waits for the store buffer.
    time.release = job.release;
    time.deadline = job.deadline;
    time.dropped = record.dropped;
    time.illegal = illegal;
    return cycle_step::begin(*record.task, time);
  }
  void count_times(Task& task, const Job& job, Nanoseconds start, Nanoseconds end, Nanoseconds used) noexcept {
    if (mechanisms::kBlame && cause_ != nullptr) cause_->ended(job.task, used, end);
    Profile& p = task.profile;
    p.execution[CHIMERA_CYCLE].add(used);
    p.response.add(end - job.release);
    p.start_delay.add(start - job.release);
  }
  void look_after(Task& task) noexcept;

  std::span<JobRecord> records_;
  MissCause* cause_;
  const bool is_tapped_, listens_;
  ContextTap& tap_;
  MissPolicy& misses_;
  JobClock& clock_;
};

}  // namespace chimera
