// SPDX-License-Identifier: Apache-2.0
// The end of jobs that do not simply publish a good result in time.
#include "chimera/runtime/job/job_cycle.h"

#include <algorithm>

namespace chimera {

void JobCycle::conclude(const Job& job, const CycleTime& time, BodyEnd body, Nanoseconds start, Nanoseconds end,
                        Nanoseconds used) noexcept {
  JobRecord& record = records_[job.task.index];
  Task& task = *record.task;
  bool may_publish = true;
  bool failed = false;
  if (body.answer != Answer::kNoEvent) {
    const std::uint8_t reported = misses_.end_reports(job.task);
    // A job that was reported late is late, even where the two looks at the clock say otherwise.
    if (reported & JobRecord::kLate) end = std::max(end, job.deadline + Nanoseconds{1});
    count_times(task, job, start, end, used);
    failed = end > job.deadline || !record.is_within_budget(used);
    if (failed) may_publish = misses_.judge(job, body, end, used, reported);
    else misses_.count_good(task);
  }
  const std::uint64_t cycles = task.profile.cycles;
  const State state = end_cycle(task, body, time, end, may_publish, &clock_);
  if (task.profile.cycles != cycles) record.dropped -= time.dropped;  // this cycle has seen those
  if (failed && MissPolicy::is_out_of_patience(task) && state == State::kOn) misses_.give_up(task, end);
  look_after(task);
}

// Collects the results of a job that others must see.
void JobCycle::look_after(Task& task) noexcept {
  JobRecord& record = records_[task.id.index];
  task.has_news = false;
  if (!listens_) {
    record.told_seen = task.faults.told;
    record.faults_seen = task.faults.count;
  }
  const bool has_fault = task.faults.told != record.told_seen;
  if (task.state != State::kOn || task.has_sent() || has_fault)
    record.left.fetch_or(JobRecord::kSettle, std::memory_order_relaxed);
  else if (task.is_tapped)
    tap_.job_published(task);
}

}  // namespace chimera
