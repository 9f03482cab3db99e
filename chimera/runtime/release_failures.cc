// SPDX-License-Identifier: Apache-2.0
// Releases: the failures of time and the reactions to them.
#include <bit>

#include "chimera/runtime/release.h"

namespace chimera {

bool Releases::decide_start(const Job& job, Nanoseconds now) noexcept {
  OfTask& t = of_[job.task.index];
  Task& task = tasks_[job.task.index];
  const DroppedRelease dropped{job.task, job.release, 1};
  if (t.skip_next) {
    t.skip_next = false;
    drop_on_purpose(dropped);
    return false;
  }
  const OnMiss reaction = task.spec->on_miss;
  if (task.spec->min_time > Nanoseconds{}) ++task.profile.min_refused;
  if (reaction == OnMiss::kFlag) want(task, kRaiseFlag);
  if (reaction == OnMiss::kContinue || reaction == OnMiss::kFlag) return true;
  tap_.record(TapKind::kMiss, now, job.task, task.call.cycle);
  drop(dropped);
  if (reaction == OnMiss::kStop) want(task, kStop);
  if (reaction == OnMiss::kError) {
    record_fault(task, Method::kCycle, "its minimum time can no longer be granted", now);
    follow_error(task, rule(Step::kCycle).next[static_cast<int>(Answer::kFault)], now);
  }
  if (is_out_of_patience(task) && task.state == State::kOn) give_up(task, now);
  want(task, kSettle);
  return false;
}

void Releases::conclude_job(const Job& job, const CycleTime& time, BodyEnd body, Nanoseconds start, Nanoseconds end,
                            Nanoseconds used) noexcept {
  Task& task = tasks_[job.task.index];
  OfTask& t = of_[job.task.index];
  bool may_publish = true;
  bool failed = false;
  if (body.answer != Answer::kNoEvent) {
    Profile& p = task.profile;
    if (blame_) blame_->ended(job.task, used, end);
    p.execution[CHIMERA_CYCLE].add(used);
    p.response.add(end - job.release);
    p.start_delay.add(start - job.release);
    failed = end > job.deadline || used > t.budget;
    if (failed) may_publish = judge(task, job, body, end, used);
    else p.missed_in_a_row = 0;
    if (!failed && task.spec->tolerated_of > 0) (void)is_tolerated(task, false);
  }
  const std::uint64_t cycles = task.profile.cycles;
  const State state = end_cycle(task, body, time, end, may_publish);
  if (task.profile.cycles != cycles) t.dropped -= time.dropped;  // this cycle was told of those
  if (failed && is_out_of_patience(task) && state == State::kOn) give_up(task, end);
  const bool listens = tap_.is_on() || options_.guest != nullptr;
  const bool tells = listens && task.faults.count != t.faults_seen;
  if (task.state != State::kOn || !task.outbox.empty() || tells) want(task, kSettle);
  else if (task.is_tapped && options_.threads == nullptr) tap_.append_row(task);
}

// m-in-n: were there at most so many misses in the last cycles, this one included?
bool Releases::is_tolerated(Task& task, bool missed) noexcept {
  OfTask& t = of_[task.id.index];
  const TaskSpec& s = *task.spec;
  const std::uint64_t window = s.tolerated_of >= 64 ? ~std::uint64_t{0} : (std::uint64_t{1} << s.tolerated_of) - 1;
  t.history = t.history << 1 | (missed ? 1u : 0u);
  return static_cast<std::uint32_t>(std::popcount(t.history & window)) <= s.tolerated_misses;
}

// A failure of time was seen: counts it and says whether the result may still be published.
bool Releases::judge(Task& task, const Job& job, BodyEnd& body, Nanoseconds end, Nanoseconds used) noexcept {
  bool may_publish = true;
  if (used > of_[job.task.index].budget) {
    ++task.profile.overrun;
    // Jobs with threads, and those that were demoted for it, were seen to use too much while they ran.
    if (options_.threads == nullptr && task.spec->on_overrun != OnMiss::kDemote)
      tap_.record(TapKind::kOverrun, end, task.id, task.call.cycle, used.count);
    may_publish = react(task.spec->on_overrun, task, body, "used more execution time than its budget", end);
  }
  const bool is_late = end > job.deadline;
  const bool tolerated = task.spec->tolerated_of > 0 && is_tolerated(task, is_late) && is_late;
  if (!is_late) {
    task.profile.missed_in_a_row = 0;
    return may_publish;
  }
  count_miss(task, end, end - job.deadline);
  if (tolerated) {
    ++task.profile.tolerated;
    return may_publish;
  }
  return react(task.spec->on_miss, task, body, "missed its deadline", end) && may_publish;
}

bool Releases::react(OnMiss reaction, Task& task, BodyEnd& body, const char* why, Nanoseconds at) noexcept {
  switch (reaction) {
    case OnMiss::kContinue:
    case OnMiss::kDemote:
    case OnMiss::kSwitch:
      return true;
    case OnMiss::kHold:
      return false;
    case OnMiss::kSkip:
      of_[task.id.index].skip_next = true;
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
      want(task, kRaiseFlag);
      return true;
    case OnMiss::kStop:
      want(task, kStop);
      return true;
  }
  return true;
}

// max_consecutive: the component may degrade or shut down in error(), but the task ends in ERROR either way.
void Releases::give_up(Task& task, Nanoseconds at) noexcept {
  record_fault(task, Method::kCycle, "missed as many deadlines in a row as max_consecutive allows", at);
  follow_error(task, rule(Step::kCycle).next[static_cast<int>(Answer::kFault)], at);
  task.state = State::kError;
  task.profile.missed_in_a_row = 0;
}

void Releases::count_miss(Task& task, Nanoseconds at, Nanoseconds lateness) noexcept {
  want_blame(task, at - lateness - task.spec->deadline);
  ++task.profile.missed;
  ++task.profile.missed_in_a_row;
  tap_.record(TapKind::kMiss, at, task.id, task.call.cycle, lateness.count);
}

void Releases::expire_waiting(const Job& job) noexcept {
  tap_.record(TapKind::kRelease, job.release, job.task, tasks_[job.task.index].call.cycle, time_to_deadline(job));
  tap_.record(TapKind::kMiss, job.deadline, job.task, tasks_[job.task.index].call.cycle);
  drop(DroppedRelease{job.task, job.release, 1});
}

void Releases::drop_on_purpose(const DroppedRelease& dropped) noexcept {
  tasks_[dropped.task.index].profile.dropped += dropped.count;
  of_[dropped.task.index].dropped += dropped.count;
  tap_.record(TapKind::kDrop, dropped.last, dropped.task, dropped.count);
}

void Releases::drop(const DroppedRelease& dropped) noexcept {
  drop_on_purpose(dropped);
  Task& task = tasks_[dropped.task.index];
  task.profile.missed += dropped.count;
  task.profile.missed_in_a_row += dropped.count;
  want_blame(task, dropped.last - task.spec->period * (std::int64_t{dropped.count} - 1));
  if (is_out_of_patience(task)) patience_lost_ = true;
}

// Tasks that others never let start have nobody else to end them.
void Releases::give_up_starved(Nanoseconds now) noexcept {
  patience_lost_ = false;
  for (Task& task : tasks_) {
    const OfTask& t = of_[task.id.index];
    if (!t.is_on || task.is_busy || !is_out_of_patience(task)) continue;
    give_up(task, now);
    settle(task, now);
  }
}

void Releases::tell_blame(TaskId missed, Nanoseconds now) noexcept {
  if (const auto verdict = blame_->judge(missed, now))
    options_.guest->missed(missed, verdict->culprit, verdict->used, now);
}

}  // namespace chimera
