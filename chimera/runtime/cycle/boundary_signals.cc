// SPDX-License-Identifier: Apache-2.0
// Carries out signals at a cycle boundary and records them.
#include "chimera/runtime/cycle/boundary_signals.h"

#include <algorithm>
#include <utility>

namespace chimera {

void BoundarySignals::begin(Nanoseconds origin) noexcept {
  origin_ = origin;
  asked_ = {};
  look_ahead(kNever, kNever);
}

void BoundarySignals::look_ahead(Nanoseconds due, Nanoseconds wake) noexcept {
  const Nanoseconds at = script_.next_at();
  const Nanoseconds act = at == kNever ? kNever : origin_ + at;
  other_act_ = other_act_in_row_ = std::min(act, due);
  other_wake_ = std::min(act, wake);
  if constexpr (mechanisms::kSwitch) {
    other_act_ = std::min({other_act_, switching_->due(), asks_again_});
    other_act_in_row_ = std::min(other_act_in_row_, switching_->due(true));
    other_wake_ = std::min({other_wake_, switching_->wake(), asks_again_});
  }
  look_ahead_to(events_);
}

void BoundarySignals::look_ahead_to(Nanoseconds events) noexcept {
  events_ = events;
  next_act_ = std::min(other_act_, events);
  next_act_in_row_ = std::min(other_act_in_row_, events);
  next_wake_ = std::min(other_wake_, events);
}

void BoundarySignals::act(Nanoseconds now) noexcept {
  while (const ScriptAct* next = script_.take(now - origin_)) act(*next, now);
  if constexpr (mechanisms::kSwitch) pass_request_on(now);
  step(now);
}

// The last request stands. A task may ask in each cycle for what is refused.
void BoundarySignals::pass_request_on(Nanoseconds now) noexcept {
  if (const SwitchRequest last = set_.sent().take_request()) request_ = last;
  asks_again_ = kNever;
  if (!request_) return;
  const bool is_the_same = request_.is_for(asked_) && request_.by == asked_.by && request_.cause == asked_.cause;
  if (!is_the_same) asked_ = {};
  if (asked_ && now < asked_at_ + kAskAgain) {
    asks_again_ = asked_at_ + kAskAgain;
    return;
  }
  const SwitchRequest next = std::exchange(request_, {});
  if (switching_->ask(next, now)) asked_ = next, asked_at_ = now;
}

// A switch may end in the step, and another one or another try be ordered.
void BoundarySignals::step(Nanoseconds now) noexcept {
  if constexpr (!mechanisms::kSwitch) return;
  if (orders_ != nullptr) (void)orders_->look(now);
  switching_->step(now);
  if (orders_ != nullptr && orders_->look(now)) switching_->step(now);
}

void BoundarySignals::act(const ScriptAct& act, Nanoseconds now) noexcept {
  if (mechanisms::kSwitch && act.kind == ScriptAct::Kind::kSwitch) {
    switching_->stop_watching(now);
    return orders_->ask(act.request(), now);
  }
  if (mechanisms::kOperators && act.kind == ScriptAct::Kind::kSet)
    return set_.table().set_operator(act.operator_index, act.value, now);
  if (act.kind != ScriptAct::Kind::kSignal) {
    const bool up = act.kind == ScriptAct::Kind::kRaiseFlag;
    set_.flag().raise(up);
    tap_.record(TapKind::kFlag, now, TaskId(), up ? 1 : 0);
    return;
  }
  Task& task = set_.tasks()[act.task.index];
  if (mechanisms::kSwitch && orders_ != nullptr) orders_->note_word(act.task, act.signal);
  if (act.signal == Signal::kWakeup) return ring(task, now);
  if (may_touch(act.task)) return carry_out(task, act.signal, now);
  // A task with a job under way takes the signal like one that it sent itself: after the job and its error handling.
  task.has_news = true;
  if (!task.outbox.try_push({act.signal, act.task})) tap_.record(TapKind::kSignal, now, task.id, 0, 0);
}

void BoundarySignals::carry_out_pending(Nanoseconds now) noexcept {
  for (Task& task : set_.tasks()) {
    Signal signal;
    while (!task.pending.empty() && !task.in_service() && may_touch(task.id) && set_.sent().take_pending(task, signal))
      carry_out(task, signal, now);
  }
}

// The script's own `on` has ended what kept the task OFF, so the one that is refused was sent by a task.
void BoundarySignals::carry_out(Task& task, Signal signal, Nanoseconds now) noexcept {
  const bool is_kept_off = mechanisms::kSwitch && signal == Signal::kOn && orders_ != nullptr &&
                           orders_->is_kept_off(task.id);
  SignalReport report{false, false, Refusal::kKeptOff, signal, task.id, task.state, task.state};
  if (is_kept_off) record(report, set_.flag().is_up(), now);
  else report = this->signal({&task.id, 1}, signal, now);
  if (!report.is_accepted) (void)refused_.try_push({now, task.id, signal, report.why, report.before, report.set});
  if (guest_ != nullptr) guest_->told(report, now);
}

void BoundarySignals::ring(Task& task, Nanoseconds now) noexcept {
  const bool counts = set_.sent().ring(task.id);
  if (!counts) (void)refused_.try_push({now, task.id, Signal::kWakeup, Refusal::kState, task.state});
  tap_.record(TapKind::kSignal, now, task.id, static_cast<std::uint64_t>(Signal::kWakeup), counts ? 1 : 0);
}

SignalReport BoundarySignals::signal(std::span<const TaskId> tasks, Signal signal, Nanoseconds now) noexcept {
  const bool was_illegal = set_.flag().is_up();
  const bool was_warm = tasks.size() == 1 && set_.tasks()[tasks[0].index].is_warm();
  SignalReport report{false, false, Refusal::kSwitch, signal, tasks[0]};
  std::optional<SwitchOrder> order;
  if constexpr (mechanisms::kSwitch) order = switching_->under_way();
  if (order && keeps_out(set_, *order, tasks, signal)) {
    report.before = report.after = set_.tasks()[tasks[0].index].shown_state();
    report.set = order->after;
  } else {
    report = set_.life().signal(tasks, signal, now);
  }
  if (was_warm && signal == Signal::kOn && report)
    tap_.record(TapKind::kState, now, tasks[0], static_cast<std::uint64_t>(State::kOn));
  record(report, was_illegal, now);
  return report;
}

SignalReport BoundarySignals::operate(std::span<const TaskId> tasks, Signal signal, Nanoseconds now) noexcept {
  if (orders_ != nullptr)
    for (const TaskId id : tasks) orders_->note_word(id, signal);
  return this->signal(tasks, signal, now);
}

void BoundarySignals::warm_up(TaskId task, Nanoseconds now) noexcept {
  const bool was_illegal = set_.flag().is_up();
  record(set_.life().warm_up(task, now), was_illegal, now);
}

SignalReport BoundarySignals::finish_slow(TaskId task, Nanoseconds now) noexcept {
  const bool was_illegal = set_.flag().is_up();
  const SignalReport report = set_.life().finish_slow(task, now);
  record_outcome(task, was_illegal, now);
  return report;
}

void BoundarySignals::record(const SignalReport& report, bool was_illegal, Nanoseconds now) noexcept {
  const int accepted = report.is_accepted ? 1 : 0;
  tap_.record(TapKind::kSignal, now, report.task, static_cast<std::uint64_t>(report.signal), accepted);
  record_outcome(report.task, was_illegal, now);
}

void BoundarySignals::record_outcome(TaskId task, bool was_illegal, Nanoseconds now) noexcept {
  Task& touched = set_.tasks()[task.index];
  settlement_.record_faults(touched);
  settlement_.follow_error(touched, now);
  if (set_.flag().is_up() != was_illegal) tap_.record(TapKind::kFlag, now, TaskId(), was_illegal ? 0 : 1);
}

}  // namespace chimera
