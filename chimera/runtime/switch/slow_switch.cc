// SPDX-License-Identifier: Apache-2.0
// Carries out the steps of a slow switch in one context, forwards and backwards.
#include "chimera/runtime/switch/slow_switch.h"

#include <algorithm>

#include "chimera/runtime/switch/arming.h"
#include "chimera/runtime/switch/present_value.h"

namespace chimera {

void SlowSwitch::prepare() {
  planner_.prepare(parts_.set.spec(), parts_.set.setup_memory());
  here_.prepare();
}

void SlowSwitch::begin(SwitchAgreement agreement, const SwitchPlan& plan, const SwitchOrder& order,
                       SwitchPeers& peers, std::uint32_t me) noexcept {
  plan_ = &plan;
  order_ = order;
  peers_ = &peers;
  steps_ = planner_.plan(plan, order.constants, order.slow);
  here_.begin(order_);
  course_ = SlowCourse(steps_);
  held_since_ = wake_ = kNever;
  was_raised_ = parts_.set.flag().is_raised();
  is_safe_ = false;
  (void)agreement.agree(order.number, me);  // no context commits before all have agreed
  peers.ring();
}

// A context that has come back since its death knows nothing of the switch.
bool SlowSwitch::is_of_dead(std::size_t step) const noexcept {
  if (is_mine(step)) return false;
  const std::uint32_t context = parts_.set.spec().tasks[steps_[step].task.index].rtpu.index;
  if (((peers_->living() >> context) & 1u) == 0) return true;
  const SwitchProgress* const progress = peers_->progress(context);
  return progress != nullptr && progress->over.load(std::memory_order_acquire) == order_.number;
}

// An aborted switch is turned round by the context whose step it is, which knows that no method of it is under way; for
// a dead one by any.
bool SlowSwitch::turns_round(std::size_t done) const noexcept {
  const auto step = course_.turn_at(static_cast<std::uint16_t>(done));
  return !step || is_mine(*step) || is_of_dead(*step);
}

bool SlowSwitch::step(SwitchAgreement agreement, Nanoseconds now) noexcept {
  for (;;) {
    wake_ = kNever;
    const PlanWord plan = agreement.plan();
    const auto turn = agreement.run(order_.number);
    const std::size_t done = turn.value_or(0) & ~TurnWord::kBack;
    if (plan.number != order_.number || !turn || done > steps_.size()) return false;  // overwritten: see restore()
    if (plan.phase == SwitchPhase::kCommitted) return conclude(SwitchEnd::kDone, now), true;
    const bool is_back = (*turn & TurnWord::kBack) != 0;
    if (done > course_.n_checks()) hold_flag(now);
    if (is_back && done <= course_.n_checks()) return conclude(SwitchEnd::kAborted, now), true;
    const auto pass_on = [&](std::size_t to, std::uint16_t back) {
      parts_.set.on_set_changed();
      peers_->show();
      (void)agreement.move_turn(order_.number, *turn, static_cast<std::uint16_t>(to | back));
      peers_->ring();
    };
    if (is_back) {
      const std::size_t step = course_.undone_with(done);
      if (!is_mine(step) && !is_of_dead(step)) return false;
      if (is_mine(step) && here_.undo(steps_[step], now) == StepEnd::kWaits) {
        wake_ = here_.wake();
        return false;
      }
      pass_on(done - 1, TurnWord::kBack);
    } else if (plan.phase == SwitchPhase::kAborted) {
      if (!turns_round(done)) return false;
      const bool has_begun = done < steps_.size() && is_mine(done) && here_.has_begun(steps_[done]);
      pass_on(course_.left_of(has_begun ? done + 1 : done), TurnWord::kBack);
    } else if (!may_go_on(agreement, done, now)) {
      continue;
    } else if (done == steps_.size()) {
      if (!turns_round(done) || !agreement.have_all_agreed(order_.number)) return false;
      const Nanoseconds at = agreement.round_up(now);
      if (at == kNever) abort(agreement, NoSwitch::kLate, {}, {});
      else if (agreement.commit(order_.number, at)) peers_->ring();
    } else if (is_mine(done)) {
      const StepEnd end = carry_out(agreement, steps_[done], now);
      if (end == StepEnd::kWaits) return false;
      if (end == StepEnd::kDone) pass_on(done + 1, 0);
    } else {
      wake_ = order_.until + kAbortGrace;
      return false;
    }
    now = std::max(now, parts_.clock.now());
  }
}

// True if all taking part are as the steps so far have left them, and there is still time. Otherwise aborts the switch.
bool SlowSwitch::may_go_on(SwitchAgreement agreement, std::size_t done, Nanoseconds now) noexcept {
  const auto fails = [&](NoSwitch why, TaskId of, VariableId variable = {}) {
    abort(agreement, why, of, variable);
    return false;
  };
  const TaskId disturbed = find_disturbed(done);
  if (disturbed.is_valid()) return fails(NoSwitch::kDisturbed, disturbed);
  if (parts_.set.flag().is_raised() && !was_raised_)
    return fails(NoSwitch::kFlagRaised, parts_.set.flag().raised_by());
  if ((order_.members & ~peers_->living()) != 0) return fails(NoSwitch::kMemberDied, {});
  const bool is_next = done < steps_.size() && is_mine(done);
  if (now < order_.until + (is_next ? Nanoseconds{} : kAbortGrace)) return true;
  const SafeCondition& asked = asked_of(parts_.set.spec(), order_.after);
  if (is_next && !is_safe_ && asked.is_there()) return fails(NoSwitch::kNotSafe, {}, asked.variable);
  if (!is_next) return fails(NoSwitch::kNotReady, {});
  if (steps_[done].act != SlowAct::kOn) return fails(NoSwitch::kNotReady, steps_[done].task);
  Task& next = parts_.set.tasks()[steps_[done].task.index];
  const VariableId missing = missing_value(parts_.set, next, {});
  return fails(missing.is_valid() ? NoSwitch::kNoValue : NoSwitch::kNotReady, steps_[done].task, missing);
}

// A signal or another switch may have created a task already that is still to be spawned.
bool SlowSwitch::is_as_left(const Task& task, std::size_t done) const noexcept {
  State state = order_.on.has(task.id) ? State::kOn : State::kOff;
  bool is_to_come = false;
  for (std::size_t i = 0; i < steps_.size(); ++i) {
    if (steps_[i].task != task.id) continue;
    if (i >= done) is_to_come = is_to_come || steps_[i].act == SlowAct::kSpawn;
    else if (steps_[i].act == SlowAct::kOff || steps_[i].act == SlowAct::kSpawn) state = State::kOff;
    else if (steps_[i].act == SlowAct::kKill) state = State::kNotCreated;
    else if (steps_[i].act == SlowAct::kOn) state = State::kOn;
  }
  if (here_.is_under_way(task.id)) return true;
  return !task.in_service() && (task.state == state || (is_to_come && task.state == State::kNotCreated));
}

TaskId SlowSwitch::find_disturbed(std::size_t done) const noexcept {
  for (const auto ids : {plan_->arriving, plan_->leaving, plan_->staying})
    for (const TaskId id : ids) {
      if (!parts_.set.is_mine(id)) continue;
      const Task& each = parts_.set.tasks()[id.index];
      if (!is_as_left(each, done)) return id;
    }
  for (const Task& each : parts_.set.tasks()) {
    const bool is_of_order = order_.on.has(each.id) || order_.target.has(each.id);
    if (parts_.set.is_mine(each.id) && each.shown_state() == State::kOn && !is_of_order) return each.id;
  }
  return {};
}

void SlowSwitch::abort(SwitchAgreement agreement, NoSwitch why, TaskId of, VariableId variable) noexcept {
  if (!agreement.abort(order_.number)) return;
  SwitchReceipt& receipt = parts_.record.receipt();
  receipt.why = why;
  receipt.task = of;
  receipt.variable = variable;
  if (why == NoSwitch::kNotSafe)
    receipt.value = present_value(parts_.set, asked_of(parts_.set.spec(), order_.after));
  peers_->ring();
}

void SlowSwitch::hold_flag(Nanoseconds now) noexcept {
  IllegalFlag& flag = parts_.set.flag();
  if (flag.is_held()) return;
  if (!flag.is_up()) parts_.tap.record(TapKind::kFlag, now, TaskId(), 1);
  flag.hold(true);
  held_since_ = now;
  parts_.record.keep_last();
  parts_.set.on_set_changed();
  peers_->show();
}

// The last values of leaving tasks were kept before they went.
void SlowSwitch::conclude(SwitchEnd end, Nanoseconds now) noexcept {
  end_ = end;
  parts_.set.constants().put_in_force(end == SwitchEnd::kDone ? order_.constants_after() : order_.constants);
  parts_.set.sources().follow_others();
  const TaskBits on = end == SwitchEnd::kDone ? order_.target : order_.on;
  parts_.set.standbys().follow_switch(on);
  IllegalFlag& flag = parts_.set.flag();
  const bool was_up = flag.is_up();
  flag.hold(false);
  parts_.set.on_set_changed();
  if (was_up && !flag.is_up()) parts_.tap.record(TapKind::kFlag, now, TaskId(), 0);
  SwitchReceipt& receipt = parts_.record.receipt();
  if (held_since_ != kNever) receipt.flag = now - held_since_;
  for (const Task& each : parts_.set.tasks()) {
    const bool is_lost = end == SwitchEnd::kAborted && order_.on.has(each.id) && parts_.set.is_mine(each.id) &&
                         each.state != State::kOn;
    if (is_lost && !receipt.not_back.is_valid()) receipt.not_back = each.id;
  }
  peers_->show();
}

void SlowSwitch::cut(SwitchAgreement agreement) noexcept {
  abort(agreement, NoSwitch::kRunEnded, {}, {});
  const bool is_done = agreement.plan().phase == SwitchPhase::kCommitted;
  conclude(is_done ? SwitchEnd::kDone : SwitchEnd::kAborted, parts_.clock.now());
}

StepEnd SlowSwitch::carry_out(SwitchAgreement agreement, const SlowStep& step, Nanoseconds now) noexcept {
  TaskSet& set = parts_.set;
  const SafeCondition& asked = asked_of(set.spec(), order_.after);
  if (!is_safe_ && !set.flag().is_held() && !holds(set, asked)) {
    wake_ = std::min(order_.until, now + kLookForValue);
    return StepEnd::kWaits;
  }
  is_safe_ = true;
  if (step.act != SlowAct::kCheck) hold_flag(now);
  const bool waits = step.act != SlowAct::kCheck && (order_.slow & kSlowForConstants) != 0;
  const Nanoseconds lead = waits ? flag_lead(set.spec(), order_.on) : Nanoseconds{};
  if (waits && now < held_since_ + lead) {
    wake_ = held_since_ + lead;
    return StepEnd::kWaits;
  }
  const StepEnd end = here_.carry_out(step, now);
  wake_ = here_.wake();
  const StepFailure& failure = here_.failure();
  if (end == StepEnd::kWaits || failure.why == NoSwitch::kNone) return end;
  abort(agreement, failure.why, failure.task, failure.variable);
  parts_.record.receipt().said = failure.said;
  return end;
}

}  // namespace chimera
