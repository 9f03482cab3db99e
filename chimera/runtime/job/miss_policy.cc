// SPDX-License-Identifier: Apache-2.0
// Counts the failures of time of jobs and carries out the reactions that a task has for them.
#include "chimera/runtime/job/miss_policy.h"

#include "chimera/base/mechanisms.h"

namespace chimera {
namespace {

// Returns the reaction that remains for the end of the job, if its failure was reported while the job was under way.
OnMiss left_of(OnMiss reaction, bool was_reported) noexcept {
  const bool acts_at_once = reaction == OnMiss::kFlag || reaction == OnMiss::kStop || reaction == OnMiss::kSwitch;
  const bool is_done = was_reported && acts_at_once;
  return is_done ? OnMiss::kContinue : reaction;
}

}  // namespace

bool MissPolicy::decide_start(const Job& job, Nanoseconds now) noexcept {
  if constexpr (!mechanisms::kReactions) return true;
  JobRecord& record = records_[job.task.index];
  Task& task = tasks_[job.task.index];
  const DroppedRelease dropped{job.task, job.release, 1};
  if (record.skip_next) {
    record.skip_next = false;
    drop_on_purpose(dropped);
    return false;
  }
  const OnMiss reaction = task.spec->on_miss;
  if (task.spec->min_time > Nanoseconds{}) ++task.profile.min_refused;
  if (reaction == OnMiss::kFlag || reaction == OnMiss::kSwitch)
    leave_reaction(job.task, reaction, JobRecord::kSwitchForMiss);
  if (reaction == OnMiss::kContinue || reaction == OnMiss::kFlag || reaction == OnMiss::kSwitch) return true;
  tap_.record(TapKind::kMiss, now, job.task, task.call.cycle);
  drop(dropped);
  if (reaction == OnMiss::kStop) leave(job.task, JobRecord::kStop);
  if (reaction == OnMiss::kError) {
    record_fault(task, Method::kCycle, "its minimum time can no longer be granted", now);
    follow_error(task, rule(Step::kCycle).next[static_cast<int>(Answer::kFault)], now, &clock_);
  }
  if (is_out_of_patience(task) && task.state == State::kOn) give_up(task, now);
  leave(job.task, JobRecord::kSettle);
  return false;
}

std::uint8_t MissPolicy::end_reports(TaskId task) noexcept {
  return records_[task.index].reported.fetch_or(JobRecord::kEnded, std::memory_order_acq_rel);
}

bool MissPolicy::judge(const Job& job, BodyEnd& body, Nanoseconds end, Nanoseconds used,
                       std::uint8_t reported) noexcept {
  Task& task = tasks_[job.task.index];
  JobRecord& record = records_[job.task.index];
  bool may_publish = true;
  if (!record.is_within_budget(used)) {
    const bool is_reported = (reported & JobRecord::kOverrun) != 0;
    ++task.profile.overrun;
    if (!is_reported) tap_.record(TapKind::kOverrun, end, task.id, task.call.cycle, used.count);
    const OnMiss reaction = left_of(task.spec->on_overrun, is_reported);
    may_publish = react(reaction, JobRecord::kSwitchForOverrun, task, body, end);
  }
  const bool is_late = end > job.deadline;
  const bool tolerated = task.spec->tolerated_of > 0 && record.history.add(is_late, *task.spec) && is_late;
  if (!is_late) {
    task.profile.missed_in_a_row = 0;
    return may_publish;
  }
  if (!(reported & (JobRecord::kLate | JobRecord::kLateUnstarted))) leave_cause(job.task, job.release);
  count_miss(task, end, end - job.deadline);
  if (tolerated) {
    ++task.profile.tolerated;
    return may_publish;
  }
  const OnMiss reaction = left_of(task.spec->on_miss, (reported & JobRecord::kLate) != 0);
  return react(reaction, JobRecord::kSwitchForMiss, task, body, end) && may_publish;
}

void MissPolicy::count_good(Task& task) noexcept {
  task.profile.missed_in_a_row = 0;
  if (task.spec->tolerated_of > 0) (void)records_[task.id.index].history.add(false, *task.spec);
}

void MissPolicy::abandon(const Job& job) noexcept {
  leave_cause(job.task, job.release);
  count_miss(tasks_[job.task.index], job.deadline, {});
}

void MissPolicy::expire_unstarted(const Job& job) noexcept {
  tap_.record_release(job);
  tap_.record(TapKind::kMiss, job.deadline, job.task, tasks_[job.task.index].call.cycle);
  drop(DroppedRelease{job.task, job.release, 1});
}

void MissPolicy::drop(const DroppedRelease& dropped) noexcept {
  drop_on_purpose(dropped);
  Task& task = tasks_[dropped.task.index];
  task.profile.missed += dropped.count;
  task.profile.missed_in_a_row += dropped.count;
  // The job that was in the way of these releases may have been reported late already.
  const bool is_known = was_reported(dropped.task, JobRecord::kLate | JobRecord::kLateUnstarted);
  if (!is_known) leave_cause(dropped.task, dropped.last - task.spec->period * (std::int64_t{dropped.count} - 1));
  if (is_out_of_patience(task)) patience_lost_ = true;
}

void MissPolicy::drop_on_purpose(const DroppedRelease& dropped) noexcept {
  add_to(tasks_[dropped.task.index].profile.dropped, dropped.count);
  records_[dropped.task.index].dropped += dropped.count;
  tap_.record(TapKind::kDrop, dropped.last, dropped.task, dropped.count);
}

// False if `what` was reported before, or the job has ended.
bool MissPolicy::report_once(TaskId task, JobRecord::Report what) noexcept {
  const int before = records_[task.index].reported.fetch_or(what, std::memory_order_acq_rel);
  return (before & (what | JobRecord::kEnded)) == 0;
}

void MissPolicy::report_late(const Job& job, bool has_begun) noexcept {
  const Task& task = tasks_[job.task.index];
  // Read before the report: the end of the job, which may come at any instant, adds to the history.
  const bool tolerated = records_[job.task.index].history.would_tolerate(*task.spec);
  if (!report_once(job.task, has_begun ? JobRecord::kLate : JobRecord::kLateUnstarted)) return;
  leave_cause(job.task, job.release);
  if (has_begun && !tolerated) leave_reaction(job.task, task.spec->on_miss, JobRecord::kSwitchForMiss);
}

bool MissPolicy::report_overrun(TaskId id, std::uint64_t cycle, Nanoseconds used, Nanoseconds now) noexcept {
  if (!report_once(id, JobRecord::kOverrun)) return false;
  tap_.record_now(TapKind::kOverrun, now, id, cycle, used.count);
  leave_reaction(id, tasks_[id.index].spec->on_overrun, JobRecord::kSwitchForOverrun);
  return true;
}

void MissPolicy::leave_reaction(TaskId task, OnMiss reaction, JobRecord::Left on_switch) noexcept {
  if (reaction == OnMiss::kSwitch) leave(task, on_switch);
  if (reaction == OnMiss::kFlag) leave(task, JobRecord::kRaiseFlag);
  if (reaction == OnMiss::kStop) leave(task, JobRecord::kStop);
}

void MissPolicy::leave_cause(TaskId task, Nanoseconds release) noexcept {
  if (!mechanisms::kBlame || cause_ == nullptr) return;
  cause_->missed(task, release);
  leave(task, JobRecord::kFindCause);
}

void MissPolicy::count_miss(Task& task, Nanoseconds at, Nanoseconds lateness) noexcept {
  ++task.profile.missed;
  ++task.profile.missed_in_a_row;
  tap_.record(TapKind::kMiss, at, task.id, task.call.cycle, lateness.count);
}

bool MissPolicy::react(OnMiss reaction, JobRecord::Left on_switch, Task& task, BodyEnd& body,
                       Nanoseconds at) noexcept {
  if constexpr (!mechanisms::kReactions) return true;
  const bool is_miss = on_switch == JobRecord::kSwitchForMiss;
  const char* const why = is_miss ? "missed its deadline" : "used more execution time than its budget";
  switch (reaction) {
    case OnMiss::kContinue:
    case OnMiss::kDemote:
      return true;
    case OnMiss::kHold:
      return false;
    case OnMiss::kSkip:
      records_[task.id.index].skip_next = true;
      return true;
    case OnMiss::kAbort:
      if (body.is_partial) return true;
      if (body.answer == Answer::kOk) body.answer = Answer::kAborted;
      return false;
    case OnMiss::kError:
      if (body.answer != Answer::kFault) record_fault(task, Method::kCycle, why, at);
      body.answer = Answer::kFault;
      return false;
    case OnMiss::kFlag:
    case OnMiss::kStop:
    case OnMiss::kSwitch:
      leave_reaction(task.id, reaction, on_switch);
      return true;
  }
  return true;
}

// The component may degrade or shut down in error(), but the task ends in ERROR either way.
void MissPolicy::give_up(Task& task, Nanoseconds at) noexcept {
  record_fault(task, Method::kCycle, "missed as many deadlines in a row as max_consecutive allows", at);
  follow_error(task, rule(Step::kCycle).next[static_cast<int>(Answer::kFault)], at, &clock_);
  task.state = State::kError;
  task.profile.missed_in_a_row = 0;
}

}  // namespace chimera
