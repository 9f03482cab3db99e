// SPDX-License-Identifier: Apache-2.0
#include "chimera/runtime/release.h"

#include <algorithm>
#include <bit>
#include <utility>

#include "chimera/base/assert.h"

namespace chimera {
namespace {

// How long before its deadline a job of the task must start. `abort` refuses a start at the deadline itself.
Nanoseconds start_margin(const TaskSpec& spec) noexcept {
  if (spec.min_time > Nanoseconds{}) return spec.min_time;
  return spec.on_miss == OnMiss::kAbort ? Nanoseconds{1} : Nanoseconds{INT64_MIN / 2};
}

bool is_built(OnMiss reaction, bool can_demote) noexcept {
  return reaction != OnMiss::kSwitch && (can_demote || reaction != OnMiss::kDemote);
}

}  // namespace

Releases::Releases(TaskSet& set, const RunOptions& options)
    : set_(set), tasks_(set.tasks()), options_(options), of_(tasks_.size()),
      tap_(tasks_, options.tap, options.rtpu, options.threads != nullptr), members_(tasks_.size()),
      classes_(tasks_.size()), queue_tasks_(tasks_.size()), loose_(tasks_.size()), pauses_(tasks_.size()),
      runs_(tasks_.size()),
      queue_(options.policy, set.spec().tasks, {members_, classes_, queue_tasks_, loose_, pauses_, runs_}) {
  for (std::size_t i = 0; i < tasks_.size(); ++i) {
    const TaskSpec& spec = *tasks_[i].spec;
    const bool can = options_.can_demote || !set.is_mine(tasks_[i].id);
    CHIMERA_ASSERT(is_built(spec.on_miss, can) && is_built(spec.on_overrun, can));
    of_[i].start_margin = start_margin(spec);
    of_[i].budget = spec.budget > Nanoseconds{} ? spec.budget : kNever;
  }
  if (options_.guest != nullptr) blame_.emplace(tasks_, options_.threads);
}

void Releases::begin(Nanoseconds origin) noexcept {
  origin_ = origin;
  queue_.set_origin(origin);
  look_at_script();
  refresh_members(origin);
}

void Releases::record_faults(Task& task) noexcept {
  OfTask& t = of_[task.id.index];
  if (task.faults.count == t.faults_seen) return;
  t.faults_seen = task.faults.count;
  set_.faulted(task);
  tap_.record(TapKind::kFault, task.faults.at, task.id, static_cast<std::uint64_t>(task.faults.method));
}

Nanoseconds Releases::next_event() const noexcept {
  const Nanoseconds next = std::min(queue_.next_release(), next_act_);
  return options_.guest == nullptr ? next : std::min(next, options_.guest->next_due());
}

void Releases::take_edge(Nanoseconds now) noexcept {
  while (const ScriptAct* next = options_.script.take(now - origin_)) act(*next, now);
  look_at_script();
  if (options_.guest != nullptr) options_.guest->take(*this, now);
  for (Task& task : tasks_) {
    Signal signal;
    while (!task.pending.empty() && !task.in_service && may_touch(task.id) && set_.take_pending(task, signal))
      carry_out(task, signal, now);
  }
  refresh_members(now);
}

void Releases::act(const ScriptAct& act, Nanoseconds now) noexcept {
  if (act.kind != ScriptAct::Kind::kSignal) {
    const bool up = act.kind == ScriptAct::Kind::kRaiseFlag;
    set_.raise_flag(up);
    tap_.record(TapKind::kFlag, now, TaskId(), up ? 1 : 0);
    return;
  }
  Task& task = tasks_[act.task.index];
  if (act.signal == Signal::kWakeup) return ring(task, now);
  // A busy task takes it like a signal it sent itself: after its job and the error handling of that.
  if (may_touch(act.task)) carry_out(task, act.signal, now);
  else if (!task.outbox.try_push({act.signal, act.task})) tap_.record(TapKind::kSignal, now, task.id, 0, 0);
}

void Releases::carry_out(Task& task, Signal signal, Nanoseconds now) noexcept {
  const bool was_illegal = set_.is_illegal();
  const SignalReport report = set_.signal(task.id, signal, now);
  if (!report.is_accepted) (void)refused_.try_push({now, task.id, signal, report.why, report.before});
  record_signal(report, was_illegal, now);
  if (options_.guest != nullptr) options_.guest->told(report, now);
}

void Releases::ring(Task& task, Nanoseconds now) noexcept {
  const bool counts = set_.ring(task.id);
  if (!counts) (void)refused_.try_push({now, task.id, Signal::kWakeup, Refusal::kState, task.state});
  tap_.record(TapKind::kSignal, now, task.id, static_cast<std::uint64_t>(Signal::kWakeup), counts ? 1 : 0);
}

void Releases::record_signal(const SignalReport& report, bool was_illegal, Nanoseconds now) noexcept {
  const int accepted = report.is_accepted ? 1 : 0;
  tap_.record(TapKind::kSignal, now, report.task, static_cast<std::uint64_t>(report.signal), accepted);
  record_outcome(report.task, was_illegal, now);
}

void Releases::record_outcome(TaskId task, bool was_illegal, Nanoseconds now) noexcept {
  record_faults(tasks_[task.index]);
  if (set_.is_illegal() != was_illegal) tap_.record(TapKind::kFlag, now, TaskId(), was_illegal ? 0 : 1);
}

SignalReport Releases::signal(std::span<const TaskId> tasks, Signal signal, Nanoseconds now) noexcept {
  const bool was_illegal = set_.is_illegal();
  const SignalReport report = set_.signal(tasks, signal, now);
  record_signal(report, was_illegal, now);
  return report;
}

SignalReport Releases::served(TaskId task, Nanoseconds now) noexcept {
  const bool was_illegal = set_.is_illegal();
  const SignalReport report = set_.served(task, now);
  record_outcome(task, was_illegal, now);
  return report;
}

void Releases::refresh_members(Nanoseconds now) noexcept {
  for (Task& task : tasks_) {
    if (options_.threads != nullptr && task.is_busy) continue;  // its thread has it
    refresh(task, now);
    if (task.is_tapped) tap_.append_row(task);
  }
}

// Makes the queue follow the state of the task.
void Releases::refresh(Task& task, Nanoseconds now) noexcept {
  OfTask& t = of_[task.id.index];
  const bool on = task.state == State::kOn;
  if (on == t.is_on) return;
  t.is_on = on;
  tap_.record(TapKind::kState, now, task.id, static_cast<std::uint64_t>(task.state));
  if (!on) {
    --n_on_;
    task.profile.events_lost += task.events;
    task.events = 0;
    queue_.leave(task.id);
    return;
  }
  ++n_on_;
  t.dropped = 0;
  t.skip_next = false;
  task.profile.missed_in_a_row = 0;
  task.last_release = now - task.spec->period;
  if (task.spec->server) return;  // released by events
  queue_.join(task.id, now);
  // dt of the first cycle is the period, whatever part of one passed since on.
  task.last_release = queue_.first_release(task.id) - task.spec->period;
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

void Releases::settle_job(TaskId id, Nanoseconds now) noexcept {
  const std::uint8_t wants = of_[id.index].wants.exchange(0, std::memory_order_relaxed);
  if (wants & kRaiseFlag) raise_flag(now);
  if (wants & kStop) task_stopped_ = true;
  if (wants & kBlame) tell_blame(id, now);
  settle(tasks_[id.index], now);
}

// After methods of the task ran outside an edge: what they left behind.
void Releases::settle(Task& task, Nanoseconds now) noexcept {
  record_faults(task);
  if (task.is_tapped) tap_.append_row(task);
  if (!task.outbox.empty()) set_.deliver(task);
  if (task.state == State::kOn) return;
  set_.on_set_changed();
  refresh(task, now);
}

void Releases::tell_blame(TaskId missed, Nanoseconds now) noexcept {
  if (const auto verdict = blame_->judge(missed, now))
    options_.guest->missed(missed, verdict->culprit, verdict->used, now);
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

void Releases::raise_flag(Nanoseconds at) noexcept {
  if (!set_.is_illegal()) tap_.record(TapKind::kFlag, at, TaskId(), 1);
  set_.raise_flag(true);
}

// max_consecutive: the component may degrade or shut down in error(), but the task ends in ERROR either way.
void Releases::give_up(Task& task, Nanoseconds at) noexcept {
  record_fault(task, Method::kCycle, "missed as many deadlines in a row as max_consecutive allows", at);
  follow_error(task, rule(Step::kCycle).next[static_cast<int>(Answer::kFault)], at);
  task.state = State::kError;
  task.profile.missed_in_a_row = 0;
}

}  // namespace chimera
