// SPDX-License-Identifier: Apache-2.0
// Releases: the failures of time and the reactions to them.
#include <bit>

#include "chimera/runtime/release.h"

namespace chimera {
namespace {

// What remains to be done at the end of a job whose failure was told while it was under way.
OnMiss left_of(OnMiss reaction, bool was_told) noexcept {
  const bool is_done = was_told && (reaction == OnMiss::kFlag || reaction == OnMiss::kStop);
  return is_done ? OnMiss::kContinue : reaction;
}

}  // namespace

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
    follow_error(task, rule(Step::kCycle).next[static_cast<int>(Answer::kFault)], now, set_.clock());
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
    const std::uint8_t told = end_telling(job.task);
    if (told & kLate) end = std::max(end, job.deadline + Nanoseconds{1});  // it could not say so before
    count_times(task, job, start, end, used);
    failed = end > job.deadline || used > t.budget;
    if (failed) may_publish = judge(task, job, body, end, used, told);
    else p.missed_in_a_row = 0;
    if (!failed && task.spec->tolerated_of > 0) (void)remember(task, false);
  }
  const std::uint64_t cycles = task.profile.cycles;
  const State state = end_cycle(task, body, time, end, may_publish, set_.clock());
  if (task.profile.cycles != cycles) t.dropped -= time.dropped;  // this cycle was told of those
  if (failed && is_out_of_patience(task) && state == State::kOn) give_up(task, end);
  look_after(task);
}

// What a job left for the others to see.
void Releases::look_after(Task& task) noexcept {
  OfTask& t = of_[task.id.index];
  task.has_news = false;
  const bool listens = tap_.is_on() || options_.guest != nullptr;
  if (!listens) t.told_seen = task.faults.told, t.faults_seen = task.faults.count;
  const bool tells = task.faults.told != t.told_seen;
  if (task.state != State::kOn || !task.outbox.empty() || tells) want(task, kSettle);
  else if (task.is_tapped && options_.threads == nullptr) tap_.append_row(task);
}

// m-in-n: were there at most so many misses in the last cycles?
bool Releases::is_tolerated(const Task& task, std::uint64_t history) const noexcept {
  const TaskSpec& s = *task.spec;
  const std::uint64_t window = s.tolerated_of >= 64 ? ~std::uint64_t{0} : (std::uint64_t{1} << s.tolerated_of) - 1;
  return s.tolerated_of > 0 && static_cast<std::uint32_t>(std::popcount(history & window)) <= s.tolerated_misses;
}

// This cycle included.
bool Releases::remember(Task& task, bool missed) noexcept {
  std::atomic<std::uint64_t>& history = of_[task.id.index].history;
  const std::uint64_t now = history.load(std::memory_order_relaxed) << 1 | (missed ? 1u : 0u);
  history.store(now, std::memory_order_relaxed);
  return is_tolerated(task, now);
}

// From here on nobody tells anything of the job; what was told of it.
std::uint8_t Releases::end_telling(TaskId task) noexcept {
  std::atomic<std::uint8_t>& told = of_[task.index].told;
  if (options_.threads == nullptr) return told.load(std::memory_order_relaxed);
  return told.fetch_or(kEnded, std::memory_order_acq_rel);
}

void Releases::want_at_once(const Task& task, OnMiss reaction) noexcept {
  if (reaction == OnMiss::kFlag) want(task, kRaiseFlag);
  if (reaction == OnMiss::kStop) want(task, kStop);
}

void Releases::tell_late(const Job& job, bool has_begun) noexcept {
  const Task& task = tasks_[job.task.index];
  // Before the job is told: its end adds to the history.
  const bool tolerated = is_tolerated(task, of_[job.task.index].history.load(std::memory_order_relaxed) << 1 | 1u);
  if (!tell(job.task, has_begun ? kLate : kWaitsLate)) return;
  want_blame(task, job.release);
  if (has_begun && !tolerated) want_at_once(task, task.spec->on_miss);
}

bool Releases::tell_overrun(TaskId id, std::uint64_t cycle, Nanoseconds used, Nanoseconds now) noexcept {
  if (!tell(id, kOverrun)) return false;
  tap_.record_now(TapKind::kOverrun, now, id, cycle, used.count);
  want_at_once(tasks_[id.index], tasks_[id.index].spec->on_overrun);
  return true;
}

// A failure of time was seen: counts it and says whether the result may still be published.
bool Releases::judge(Task& task, const Job& job, BodyEnd& body, Nanoseconds end, Nanoseconds used,
                     std::uint8_t told) noexcept {
  bool may_publish = true;
  if (used > of_[job.task.index].budget) {
    ++task.profile.overrun;
    if (!(told & kOverrun)) tap_.record(TapKind::kOverrun, end, task.id, task.call.cycle, used.count);
    const OnMiss reaction = left_of(task.spec->on_overrun, told & kOverrun);
    may_publish = react(reaction, task, body, "used more execution time than its budget", end);
  }
  const bool is_late = end > job.deadline;
  const bool tolerated = task.spec->tolerated_of > 0 && remember(task, is_late) && is_late;
  if (!is_late) {
    task.profile.missed_in_a_row = 0;
    return may_publish;
  }
  if (!(told & (kLate | kWaitsLate))) want_blame(task, job.release);
  count_miss(task, end, end - job.deadline);
  if (tolerated) {
    ++task.profile.tolerated;
    return may_publish;
  }
  return react(left_of(task.spec->on_miss, told & kLate), task, body, "missed its deadline", end) && may_publish;
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
  follow_error(task, rule(Step::kCycle).next[static_cast<int>(Answer::kFault)], at, set_.clock());
  task.state = State::kError;
  task.profile.missed_in_a_row = 0;
}

void Releases::count_miss(Task& task, Nanoseconds at, Nanoseconds lateness) noexcept {
  ++task.profile.missed;
  ++task.profile.missed_in_a_row;
  tap_.record(TapKind::kMiss, at, task.id, task.call.cycle, lateness.count);
}

void Releases::expire_waiting(const Job& job) noexcept {
  record_release(job);
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
  const bool is_known = was_told(dropped.task, kLate | kWaitsLate);  // of the job that was in its way
  if (!is_known) want_blame(task, dropped.last - task.spec->period * (std::int64_t{dropped.count} - 1));
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
    options_.guest->missed(missed, *verdict, now);
}

}  // namespace chimera
