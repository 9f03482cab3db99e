// SPDX-License-Identifier: Apache-2.0
// The step function: notes one event, then advances the parts until nothing changes any more.
#include "chimera/subsystem/subsystem.h"

#include <algorithm>

#include "chimera/subsystem/command_queue.h"
#include "chimera/subsystem/goals.h"
#include "chimera/subsystem/on_queue.h"
#include "chimera/subsystem/on_transaction.h"
#include "chimera/subsystem/restart_policy.h"
#include "chimera/subsystem/subsystem_state.h"

namespace chimera::subsystem {
namespace {

/// `init` may take longer than an answer may. The wait for an `init` under way lasts at most this long.
constexpr Nanoseconds kServiceLimit = seconds(60);

}  // namespace

struct Subsystem::Parts {
  explicit Parts(const ApplicationSpec& spec)
      : state(spec), goals(state), transaction(state, goals), commands(state, goals, transaction),
        on_queue(state, goals, transaction), restarts(state, goals, transaction, commands) {}

  void on_event(const Begun& begun);
  void on_event(const InventoryComplete&) {
    state.is_complete = true;
    state.complete_since = state.now;
  }
  void on_event(const RtpuUp& up);
  void on_event(const RtpuDown& down);
  void on_event(const TaskSeen& seen) {
    state.observed.see(seen.task, seen.status);
    transaction.on_task_seen(seen.task);
  }
  void on_event(const Reported& report);
  void on_event(const Requested& request) {
    if (request.signal == Signal::kOn) on_queue.add(request);
  }
  void on_event(const Commanded& command) {
    if (command.signal == Signal::kOn) on_queue.add(command);
    else commands.add(command);
  }
  void on_event(const PersonSwitches& to) {
    for (TaskId task : state.spec.on_order) {
      if (to.on.has(task)) goals.clear(task, kGoalOff);
      if (to.off.has(task)) goals.add(task, kGoalOff);
    }
  }
  void on_event(const Tick&) {}

  SignalRefusal refusal_of(const Reported& report) const;
  void pass_on(const SignalResult& result);
  void expire();
  void settle();

  SubsystemState state;
  Goals goals;
  OnTransaction transaction;
  CommandQueue commands;
  OnQueue on_queue;
  RestartPolicy restarts;
};

void Subsystem::Parts::on_event(const Begun& begun) {
  state.pending.begin(state.now);
  goals.recall(begun.goals);
  restarts.recall(begun);
  for (std::size_t r = 0; r < state.spec.rtpus.size(); ++r) state.observed.starting(RtpuId(r), state.now);
  if (begun.started) return;
  state.observed.begin_empty();
  for (TaskId task : state.spec.init_order) {
    if (!state.rivals.is_created_at_start(task)) continue;
    const bool starts = std::ranges::find(state.spec.start, task) != state.spec.start.end();
    goals.set(task, starts ? kGoalSpawn | kGoalOn : kGoalSpawn);
  }
  state.emit(RememberStarted{});
}

void Subsystem::Parts::on_event(const RtpuUp& up) {
  state.observed.up(up.rtpu, up.incarnation);
  for (TaskId task : state.spec.on_order) {
    if (state.observed.rtpu(task) != up.rtpu) continue;
    if (!goals.has(task, kGoalSpawn)) state.observed.forget(task);
    goals.clear(task, kGoalGone);
  }
}

void Subsystem::Parts::on_event(const RtpuDown& down) {
  if (!restarts.on_rtpu_down(down)) return;
  for (TaskId task : state.spec.on_order) {
    if (state.observed.rtpu(task) != down.rtpu) continue;
    const auto lost = state.pending.of(task);
    state.pending.drop(task);
    for (const PendingSignal& entry : lost)
      if (entry.due != kNever)
        pass_on({entry.command, task, entry.signal, State::kError, State::kError, state.ended(down.rtpu, down.cause)});
  }
}

void Subsystem::Parts::on_event(const Reported& report) {
  if (!state.pending.settle(report.task, report.command)) return;
  pass_on({report.command, report.task, report.signal, report.before, report.after, refusal_of(report)});
}

SignalRefusal Subsystem::Parts::refusal_of(const Reported& report) const {
  if (report.accepted) {
    if (has_arrived(report.signal, report.before, report.after)) return {};
    const std::string end = std::string("ended in state ") + state_name(report.after);
    return {RefusalKind::kFault, report.text.empty() ? end : report.text, {}};
  }
  switch (report.why) {
    case Refusal::kState: return state.illegal(report.signal, report.task, report.before, {&report.task, 1});
    case Refusal::kIllegalSet: return {RefusalKind::kSet, report.text, {}};
    case Refusal::kFault: return {RefusalKind::kFault, report.text.empty() ? "a method failed" : report.text, {}};
    case Refusal::kNotYet: return {RefusalKind::kNotYet, "on: it is not ready yet", {}};
    case Refusal::kRival: return {RefusalKind::kResource, "another task that is created has its resource", {}};
    case Refusal::kSwitch: return {RefusalKind::kOther, "a switch is under way", {}};
    case Refusal::kKeptOff:  // the step function judges it before it sends `on`
    case Refusal::kNone: break;
  }
  return {RefusalKind::kOther, report.text, {}};
}

void Subsystem::Parts::pass_on(const SignalResult& result) {
  transaction.on_result(result);
  goals.on_result(result);
  commands.on_result(result);
}

void Subsystem::Parts::expire() {
  for (TaskId task : state.spec.on_order) {
    std::vector<SignalResult> expired;
    for (PendingSignal& entry : state.pending.of(task)) {
      if (entry.due > state.now) continue;
      const Nanoseconds limit = entry.sent + (entry.signal == Signal::kKill ? kKillLimit : kServiceLimit);
      const bool serves = state.observed.status(task).in_service && state.now < limit;
      entry.due = serves ? std::min(state.now + kAnswerLimit, limit) : kNever;
      const State now = state.observed.state(task);
      if (!serves) expired.push_back({entry.command, task, entry.signal, now, now, state.no_answer(task)});
    }
    for (const SignalResult& result : expired) pass_on(result);
  }
}

// Advances all parts until none changes, because each part may unblock another.
void Subsystem::Parts::settle() {
  for (bool changed = true; changed;) {
    changed = goals.advance();
    changed = commands.advance() || changed;
    changed = transaction.advance() || changed;
    changed = on_queue.advance() || changed;
  }
}

Subsystem::Subsystem(const ApplicationSpec& spec) : parts_(std::make_unique<Parts>(spec)) {}
Subsystem::~Subsystem() = default;

void Subsystem::step(const Event& event, Nanoseconds now, std::vector<Action>& actions) {
  parts_->state.now = now;
  parts_->state.actions = &actions;
  std::visit([this](const auto& it) { parts_->on_event(it); }, event);
  parts_->expire();
  if (parts_->state.is_complete) parts_->settle();
}

Nanoseconds Subsystem::next_due() const noexcept {
  const Nanoseconds next = std::min(parts_->state.pending.next_due(), parts_->goals.next_due());
  if (!parts_->state.is_complete) return next;
  return std::min({next, parts_->commands.next_due(), parts_->on_queue.next_due(), parts_->transaction.next_due()});
}

State Subsystem::state(TaskId task) const noexcept { return parts_->state.observed.state(task); }

bool Subsystem::is_kept_off(TaskId task) const noexcept { return parts_->goals.has(task, kGoalOff); }

bool Subsystem::is_settled() const noexcept {
  return !parts_->goals.any(kGoalSpawn | kGoalOn) && !parts_->transaction.is_under_way();
}

bool Subsystem::is_given_up(RtpuId rtpu) const noexcept { return parts_->state.observed.life(rtpu) == RtpuLife::kDown; }

std::string Subsystem::way_back(RtpuId rtpu) const { return parts_->restarts.way_back(rtpu); }

std::string Subsystem::missing() const { return parts_->state.missing(); }

}  // namespace chimera::subsystem
