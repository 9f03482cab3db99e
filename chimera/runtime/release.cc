// SPDX-License-Identifier: Apache-2.0
#include "chimera/runtime/release.h"

#include <algorithm>

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
    of_[i].task = &tasks_[i];
    of_[i].is_plain = options.threads == nullptr && spec.tolerated_of == 0;
    of_[i].budget = spec.budget > Nanoseconds{} ? spec.budget : kNever;
  }
  if (options_.stop == nullptr) options_.stop = &kNoStop;
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
  if (task.faults.told == t.told_seen) return;
  t.told_seen = task.faults.told;
  set_.told(task);
  if (task.faults.count == t.faults_seen) return;
  t.faults_seen = task.faults.count;
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

void Releases::record_release(const Job& job) noexcept {
  const std::int64_t left = job.deadline == kNever ? 0 : (job.deadline - job.release).count;
  tap_.record(TapKind::kRelease, job.release, job.task, tasks_[job.task.index].call.cycle, left);
}

void Releases::act(const ScriptAct& act, Nanoseconds now) noexcept {
  if (act.kind == ScriptAct::Kind::kSet) return set_.set_operator(act.operator_index, act.value, now);
  if (act.kind != ScriptAct::Kind::kSignal) {
    const bool up = act.kind == ScriptAct::Kind::kRaiseFlag;
    set_.raise_flag(up);
    tap_.record(TapKind::kFlag, now, TaskId(), up ? 1 : 0);
    return;
  }
  Task& task = tasks_[act.task.index];
  if (act.signal == Signal::kWakeup) return ring(task, now);
  // A busy task takes it like a signal it sent itself: after its job and the error handling of that.
  if (may_touch(act.task)) return carry_out(task, act.signal, now);
  task.has_news = true;
  if (!task.outbox.try_push({act.signal, act.task})) tap_.record(TapKind::kSignal, now, task.id, 0, 0);
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
  task.profile.on_before = task.profile.on_by(now);
  task.profile.on_since = on ? now : kNever;
  if (on) join(task, now);
  else leave(task);
  if (options_.guest != nullptr) options_.guest->show(task);
}

void Releases::leave(Task& task) noexcept {
  --n_on_;
  task.profile.events_lost += task.events;
  task.events = 0;
  queue_.leave(task.id);
}

void Releases::join(Task& task, Nanoseconds now) noexcept {
  OfTask& t = of_[task.id.index];
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

void Releases::settle_job(TaskId id, Nanoseconds now) noexcept {
  settle_at_once(id, now);
  of_[id.index].wants.store(0, std::memory_order_relaxed);
  settle(tasks_[id.index], now);
}

void Releases::settle_at_once(TaskId id, Nanoseconds now) noexcept {
  look_again();
  const std::uint8_t wants = of_[id.index].wants.fetch_and(kSettle, std::memory_order_relaxed);
  if (wants & kRaiseFlag) raise_flag(id, now);
  if ((wants & kStop) && !task_stopped_) {
    task_stopped_ = true;
    stopped_by_ = id;
  }
  if (wants & kBlame) tell_blame(id, now);
}

// After methods of the task ran outside an edge: what they left behind.
void Releases::settle(Task& task, Nanoseconds now) noexcept {
  look_again();
  record_faults(task);
  if (task.is_tapped) tap_.append_row(task);
  if (!task.outbox.empty()) set_.deliver(task);
  if (task.state == State::kOn) return;
  set_.on_set_changed();
  refresh(task, now);
}

void Releases::raise_flag(TaskId by, Nanoseconds at) noexcept {
  if (set_.raises_flag(by)) return;
  if (!set_.is_illegal()) tap_.record(TapKind::kFlag, at, TaskId(), 1);
  set_.raise_flag_for(by);
}

}  // namespace chimera
