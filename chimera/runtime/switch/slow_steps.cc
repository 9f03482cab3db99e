// SPDX-License-Identifier: Apache-2.0
// Carries out the steps of a slow switch on the tasks of one context, forwards and backwards.
#include "chimera/runtime/switch/slow_steps.h"

#include <algorithm>

#include "chimera/runtime/switch/arming.h"

namespace chimera {
namespace {

Nanoseconds period_of(const Task& task) noexcept {
  return task.spec->aperiodic ? milliseconds(1) : task.spec->period;
}

}  // namespace

void CreationSteps::prepare(std::size_t n_tasks, SetupMemory& memory) {
  spawned_ = memory.take<bool>(n_tasks);
  killed_ = memory.take<bool>(n_tasks);
}

void CreationSteps::begin() noexcept {
  asked_ = TaskId();
  std::fill(spawned_.begin(), spawned_.end(), false);
  std::fill(killed_.begin(), killed_.end(), false);
}

void SlowSteps::begin(const SwitchOrder& order) noexcept {
  order_ = &order;
  created_.begin();
  failure_ = {};
  wake_ = waits_since_ = again_at_ = back_until_ = kNever;
  was_idle_ = false;
}

StepEnd SlowSteps::carry_out(const SlowStep& step, Nanoseconds now) noexcept {
  Task& each = task(step.task);
  wake_ = kNever;
  if (step.act == SlowAct::kCheck) return check(each);
  if (is_under_way(step.task) && each.in_service()) return StepEnd::kWaits;  // its end asks for a cycle boundary
  if (!parts_.threads.claim(step.task)) return StepEnd::kWaits;           // so does the end of its job
  switch (step.act) {
    case SlowAct::kOff: return turn_off(each, now);
    case SlowAct::kKill: return create(each, Signal::kKill, now);
    case SlowAct::kSpawn: return create(each, Signal::kSpawn, now);
    case SlowAct::kReinit: return reinit(each, now);
    default: return turn_on(each, now);
  }
}

SignalReport SlowSteps::move(Task& task, Signal signal, Nanoseconds now) noexcept {
  const SignalReport report = parts_.set.life().move(task.id, signal, now);
  parts_.tap.record(TapKind::kSignal, now, task.id, static_cast<std::uint64_t>(signal), report ? 1 : 0);
  parts_.settlement.record_faults(task);
  return report;
}

StepEnd SlowSteps::fail(NoSwitch why, const Task& task) noexcept {
  failure_ = {why, task.id, {}, {}};
  failure_.said.assign(task.faults.last.text);
  return StepEnd::kFailed;
}

StepEnd SlowSteps::wait_until(Nanoseconds instant) noexcept {
  wake_ = instant;
  return StepEnd::kWaits;
}

// The flag is up: a gap is taken where one comes soon.
bool SlowSteps::waits_for_gap(const Task& task, Method method, Nanoseconds now) noexcept {
  if (waits_since_ == kNever) waits_since_ = now;
  const Nanoseconds at_most = parts_.gap.soon();
  const bool is_vain = (order_->slow & kSlowForGap) != 0 && method == Method::kOn;
  if (!is_vain && now < waits_since_ + at_most && !parts_.gap.is_for(task, method, now)) {
    wake_ = std::min(waits_since_ + at_most, std::max(parts_.threads.next_look(now), now));
    return true;
  }
  waits_since_ = kNever;
  return false;
}

// Waits until the processor of this context was idle once: then no job of a leaving task can delay another job,
// directly or through others.
bool SlowSteps::waits_for_idle(Nanoseconds now) noexcept {
  if ((order_->slow & kSlowForDeadlines) == 0 || was_idle_) return false;
  for (const Task& each : parts_.set.tasks()) {
    if (!parts_.set.is_mine(each.id) || !parts_.threads.has_job_before(each.id, now)) continue;
    parts_.threads.await_job(each.id);
    return true;
  }
  was_idle_ = true;
  return false;
}

// One that was not ready is asked again a period later.
bool SlowSteps::waits_for_device(const Task& task, Nanoseconds now) noexcept {
  if (task.standing != Standing::kHalfOn || now >= again_at_) return false;
  wake_ = again_at_;
  return true;
}

StepEnd SlowSteps::check(const Task& task) noexcept {
  FaultWords why;
  ContextConstants& constants = parts_.set.constants();
  constants.read_foreign();
  constants.put_in_force(order_->constants_after());
  const bool is_fit = constants.would_take(task.id, why);
  constants.put_in_force(order_->constants);
  if (is_fit) return StepEnd::kDone;
  failure_ = {NoSwitch::kBadConstant, task.id, {}, FixedString<160>(why.view())};
  return StepEnd::kFailed;
}

StepEnd SlowSteps::turn_off(Task& task, Nanoseconds now) noexcept {
  if (waits_for_gap(task, Method::kOff, now)) return StepEnd::kWaits;
  parts_.record.leaves(task.id);
  const Nanoseconds began = parts_.clock.now();
  (void)move(task, Signal::kOff, now);
  parts_.record.took(task.id, Method::kOff, parts_.clock.now() - began);
  return task.state == State::kOff ? StepEnd::kDone : fail(NoSwitch::kStepFailed, task);
}

// Spawns or kills the task. The new configuration decides which constants, made at init, are in force.
StepEnd SlowSteps::create(Task& task, Signal signal, Nanoseconds now) noexcept {
  const Method method = signal == Signal::kSpawn ? Method::kInit : Method::kKill;
  const bool is_here = !is_under_way(task.id) && !parts_.set.slow().takes(method);
  if (is_here && waits_for_gap(task, method, now)) return StepEnd::kWaits;
  parts_.set.constants().put_in_force(order_->constants_after());
  const StepEnd end =
      created_.carry_out(task, signal, [&](Task& each, Signal which) { (void)move(each, which, now); });
  return end == StepEnd::kFailed ? fail(NoSwitch::kStepFailed, task) : end;
}

// A task that is already initialised with the constants in force is left as it is.
StepEnd SlowSteps::reinit(Task& task, Nanoseconds now) noexcept {
  ContextConstants& constants = parts_.set.constants();
  constants.read_foreign();
  constants.put_in_force(order_->constants_after());
  if (!constants.uses_changed(task.id)) return StepEnd::kDone;
  if (waits_for_gap(task, Method::kReinit, now)) return StepEnd::kWaits;
  const State before = task.state;
  const std::uint64_t faults = task.faults.count;
  (void)move(task, Signal::kReinit, now);
  if (task.state == before && task.faults.count == faults) {
    parts_.record.reinitialised(task.id);
    return StepEnd::kDone;
  }
  (void)fail(NoSwitch::kStepFailed, task);
  constants.put_in_force(order_->constants);
  if (task.state == before) (void)move(task, Signal::kReinit, now);
  return StepEnd::kFailed;
}

StepEnd SlowSteps::turn_on(Task& task, Nanoseconds now) noexcept {
  TaskSet& set = parts_.set;
  set.constants().put_in_force(order_->constants_after());
  set.sources().follow_others();
  if (waits_for_device(task, now)) return StepEnd::kWaits;
  const Nanoseconds again = std::min(now + period_of(task), std::max(order_->until, now + Nanoseconds{1}));
  if (missing_value(set, task, {}).is_valid()) return wait_until(again);
  if (waits_for_idle(now)) return StepEnd::kWaits;
  if (waits_for_gap(task, Method::kOn, now)) return StepEnd::kWaits;
  const Nanoseconds began = parts_.clock.now();
  const SignalReport report = move(task, Signal::kOn, now);
  parts_.record.took(task.id, Method::kOn, parts_.clock.now() - began);
  if (report.why == Refusal::kNotYet) return wait_until(again_at_ = again);
  if (task.state != State::kOn) return fail(NoSwitch::kOnFailed, task);
  parts_.record.receipt().armed = parts_.clock.now();
  const VariablePart* const beyond = parts_.record.arrives(task.id, parts_.clock.now());
  if (beyond != nullptr) failure_ = {NoSwitch::kStepTooLarge, task.id, beyond->handover.variable, {}};
  return StepEnd::kDone;  // what is done is undone as all others
}

bool SlowSteps::has_begun(const SlowStep& step) const noexcept {
  const bool is_half_on = parts_.set.tasks()[step.task.index].standing == Standing::kHalfOn;
  return step.act == SlowAct::kOn ? is_half_on : is_under_way(step.task);
}

StepEnd SlowSteps::undo(const SlowStep& step, Nanoseconds now) noexcept {
  Task& each = task(step.task);
  ContextConstants& constants = parts_.set.constants();
  wake_ = kNever;
  if (each.in_service() || !parts_.threads.claim(step.task)) return StepEnd::kWaits;
  constants.read_foreign();
  constants.put_in_force(order_->constants);
  parts_.set.sources().follow_others();
  const bool has_begun = each.state == State::kOn || each.standing == Standing::kHalfOn;
  if (step.act == SlowAct::kOn && has_begun) (void)move(each, Signal::kOff, now);
  if (step.act == SlowAct::kOff && each.state == State::kOff) return turn_on_again(each, now);
  if (step.act == SlowAct::kKill || step.act == SlowAct::kSpawn) {
    const Signal done = step.act == SlowAct::kKill ? Signal::kKill : Signal::kSpawn;
    return created_.undo(each, done, [&](Task& one, Signal which) { (void)move(one, which, now); });
  }
  const bool is_there = each.state == State::kOff || each.state == State::kOn;
  if (step.act != SlowAct::kReinit || !is_there || !constants.uses_changed(step.task)) return StepEnd::kDone;
  (void)move(each, Signal::kReinit, now);
  return StepEnd::kDone;
}

// A device that needs some time on the way back has it, for as long as a switch has by default.
StepEnd SlowSteps::turn_on_again(Task& task, Nanoseconds now) noexcept {
  if (waits_for_device(task, now)) return StepEnd::kWaits;
  const SignalReport report = move(task, Signal::kOn, now);
  if (report.why == Refusal::kNotYet) {
    if (back_until_ == kNever) back_until_ = now + kReadyLimit;
    if (now < back_until_) return wait_until(again_at_ = now + period_of(task));
    (void)move(task, Signal::kOff, now);
  }
  back_until_ = kNever;  // the next device has as long
  return StepEnd::kDone;
}

}  // namespace chimera
