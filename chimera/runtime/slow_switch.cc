// SPDX-License-Identifier: Apache-2.0
// Carries out the steps of a slow switch in one context, forwards and backwards.
#include "chimera/runtime/slow_switch.h"

#include <algorithm>

#include "chimera/runtime/arrival.h"
#include "chimera/runtime/missing_value.h"

namespace chimera {
namespace {

// How long after the deadline a context aborts that another one is to abort first, which knows why.
constexpr Nanoseconds kGrace = milliseconds(100);
// A gap is waited for no longer than this: the flag is up meanwhile.
constexpr Nanoseconds kLongestWait = milliseconds(100);
constexpr Nanoseconds kLookForSafety = milliseconds(1);

Nanoseconds longest_period(const TaskSet& set) noexcept {
  Nanoseconds longest = milliseconds(1);
  for (const Task& task : set.tasks())
    if (set.is_mine(task.id) && task.state == State::kOn && !task.spec->aperiodic)
      longest = std::max(longest, task.spec->period);
  return longest;
}

}  // namespace

void SlowSwitch::prepare() {
  planner_.prepare(parts_.set.spec(), parts_.set.setup_memory());
  created_.prepare(parts_.set.tasks().size(), parts_.set.setup_memory());
}

void SlowSwitch::begin(SwitchAgreement agreement, const SwitchPlan& plan, const SwitchOrder& order,
                       SwitchPeers& peers, std::uint32_t me) noexcept {
  plan_ = &plan;
  order_ = order;
  peers_ = &peers;
  steps_ = planner_.plan(plan, order.constants, order.slow);
  created_.begin();
  const auto is_check = [](const SlowStep& step) { return step.act == SlowAct::kCheck; };
  n_checks_ = static_cast<std::size_t>(std::count_if(steps_.begin(), steps_.end(), is_check));
  const auto is_reinit = [](const SlowStep& step) { return step.act == SlowAct::kReinit; };
  first_reinit_ = static_cast<std::size_t>(std::find_if(steps_.begin(), steps_.end(), is_reinit) - steps_.begin());
  end_of_reinits_ = first_reinit_ + static_cast<std::size_t>(std::count_if(steps_.begin(), steps_.end(), is_reinit));
  held_since_ = waits_since_ = back_until_ = wake_ = kNever;
  was_raised_ = parts_.set.flag().is_raised();
  is_safe_ = was_idle_ = false;
  (void)agreement.agree(order.number, me);  // nobody commits before all have
  peers.ring();
}

// The step that is undone next when so many are left. Users are re-initialised behind who makes their constants, on the
// way back too.
std::size_t SlowSwitch::undone_with(std::size_t left) const noexcept {
  const std::size_t step = left - 1;
  const bool is_reinit = step >= first_reinit_ && step < end_of_reinits_;
  return is_reinit ? first_reinit_ + end_of_reinits_ - 1 - step : step;
}

// One that has come back since knows nothing of the switch.
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
  if (steps_.empty()) return true;
  const std::size_t step = std::min(done, steps_.size() - 1);
  return is_mine(step) || is_of_dead(step);
}

bool SlowSwitch::step(SwitchAgreement agreement, Nanoseconds now) noexcept {
  for (;;) {
    wake_ = kNever;
    const PlanWord plan = agreement.plan();
    const auto turn = agreement.run(order_.number);
    if (plan.number != order_.number || !turn) return conclude(SwitchEnd::kAborted, now), true;
    if (plan.phase == SwitchPhase::kCommitted) return conclude(SwitchEnd::kDone, now), true;
    const bool is_back = (*turn & TurnWord::kBack) != 0;
    const std::size_t done = *turn & ~TurnWord::kBack;
    if (done > n_checks_) hold_flag(now);
    if (is_back && done <= n_checks_) return conclude(SwitchEnd::kAborted, now), true;
    const auto pass_on = [&](std::size_t to, std::uint16_t back) {
      parts_.set.on_set_changed();
      peers_->show();
      (void)agreement.move_turn(order_.number, *turn, static_cast<std::uint16_t>(to | back));
      peers_->ring();
    };
    if (is_back) {
      const std::size_t step = undone_with(done);
      if (!is_mine(step) && !is_of_dead(step)) return false;
      if (is_mine(step) && undo(steps_[step], now) == StepEnd::kWaits) return false;
      pass_on(done - 1, TurnWord::kBack);
    } else if (plan.phase == SwitchPhase::kAborted) {
      std::size_t left = done;
      if (!turns_round(done) || !leave(done, left, now)) return false;
      pass_on(left > first_reinit_ ? std::max(left, end_of_reinits_) : left, TurnWord::kBack);
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
      wake_ = order_.until + kGrace;
      return false;
    }
    now = std::max(now, parts_.clock.now());
  }
}

// Whoever takes part is as the steps so far have left it, and there is still time; else the switch is aborted.
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
  if (now < order_.until + (is_next ? Nanoseconds{} : kGrace)) return true;
  const SafeCondition& asked = asked_of(parts_.set.spec(), order_.after);
  if (is_next && !is_safe_ && asked.is_there()) return fails(NoSwitch::kNotSafe, {}, asked.variable);
  if (!is_next) return fails(NoSwitch::kNotReady, {});
  if (steps_[done].act != SlowAct::kOn) return fails(NoSwitch::kNotReady, steps_[done].task);
  const VariableId missing = missing_value(parts_.set, task(steps_[done].task), {});
  return fails(missing.is_valid() ? NoSwitch::kNoValue : NoSwitch::kNotReady, steps_[done].task, missing);
}

// A task that is to be spawned may be there already, by somebody else.
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
  if (created_.is_under_way(task.id)) return true;
  return !task.in_service && (task.state == state || (is_to_come && task.state == State::kNotCreated));
}

TaskId SlowSwitch::find_disturbed(std::size_t done) const noexcept {
  for (const auto ids : {plan_->arriving, plan_->leaving, plan_->staying})
    for (const TaskId id : ids) {
      if (!parts_.set.is_mine(id)) continue;
      const Task& each = parts_.set.tasks()[id.index];
      if (!is_as_left(each, done)) return id;
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

// The last values of who leaves were kept before they went.
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

SignalReport SlowSwitch::move(Task& task, Signal signal, Nanoseconds now) noexcept {
  const SignalReport report = parts_.set.life().move(task.id, signal, now);
  parts_.tap.record(TapKind::kSignal, now, task.id, static_cast<std::uint64_t>(signal), report ? 1 : 0);
  parts_.settlement.record_faults(task);
  return report;
}

// The flag is up: a gap is taken where one comes soon.
bool SlowSwitch::waits_for_gap(const Task& task, Method method, Nanoseconds now) noexcept {
  if (waits_since_ == kNever) waits_since_ = now;
  const Nanoseconds at_most = std::min(longest_period(parts_.set), kLongestWait);
  const bool is_vain = (order_.slow & kSlowForGap) != 0 && method == Method::kOn;
  if (!is_vain && now < waits_since_ + at_most && !parts_.gap.is_for(task, method, now)) {
    wake_ = std::min(waits_since_ + at_most, std::max(parts_.threads.next_look(now), now));
    return true;
  }
  waits_since_ = kNever;
  return false;
}

StepEnd SlowSwitch::carry_out(SwitchAgreement agreement, const SlowStep& step, Nanoseconds now) noexcept {
  Task& each = task(step.task);
  TaskSet& set = parts_.set;
  const SafeCondition& asked = asked_of(set.spec(), order_.after);
  if (!is_safe_ && !set.flag().is_held() && !holds(set, asked)) {
    wake_ = std::min(order_.until, now + kLookForSafety);
    return StepEnd::kWaits;
  }
  is_safe_ = true;
  if (step.act == SlowAct::kCheck) return check(agreement, each);
  hold_flag(now);
  const Nanoseconds lead = (order_.slow & kSlowForConstants) != 0 ? flag_lead(set.spec(), order_.on) : Nanoseconds{};
  if (now < held_since_ + lead) {
    wake_ = held_since_ + lead;
    return StepEnd::kWaits;
  }
  if (created_.is_under_way(step.task) && each.in_service) return StepEnd::kWaits;  // its end asks for an edge
  if (!parts_.threads.claim(step.task)) return StepEnd::kWaits;                    // so does the end of its job
  switch (step.act) {
    case SlowAct::kOff: return turn_off(agreement, each, now);
    case SlowAct::kKill: return create(agreement, each, Signal::kKill, now);
    case SlowAct::kSpawn: return create(agreement, each, Signal::kSpawn, now);
    case SlowAct::kReinit: return reinit(agreement, each, now);
    default: return turn_on(agreement, each, now);
  }
}

// Says so on the page, with the text of the last fault of the task.
StepEnd SlowSwitch::fail(SwitchAgreement agreement, NoSwitch why, const Task& task) noexcept {
  abort(agreement, why, task.id, {});
  parts_.record.receipt().said.assign(task.faults.last.text);
  return StepEnd::kFailed;
}

StepEnd SlowSwitch::check(SwitchAgreement agreement, const Task& task) noexcept {
  FixedString<160> why;
  ContextConstants& constants = parts_.set.constants();
  constants.read_foreign();
  constants.put_in_force(order_.constants_after());
  const bool is_fit = constants.would_take(task.id, why);
  constants.put_in_force(order_.constants);
  if (is_fit) return StepEnd::kDone;
  abort(agreement, NoSwitch::kBadConstant, task.id, {});
  parts_.record.receipt().said = why;
  return StepEnd::kFailed;
}

StepEnd SlowSwitch::turn_off(SwitchAgreement agreement, Task& task, Nanoseconds now) noexcept {
  if (waits_for_gap(task, Method::kOff, now)) return StepEnd::kWaits;
  parts_.record.leaves(task.id);
  const Nanoseconds began = parts_.clock.now();
  (void)move(task, Signal::kOff, now);
  parts_.record.took(task.id, Method::kOff, parts_.clock.now() - began);
  return task.state == State::kOff ? StepEnd::kDone : fail(agreement, NoSwitch::kStepFailed, task);
}

// Spawns it, or kills it. What a task makes at init counts by the configuration after.
StepEnd SlowSwitch::create(SwitchAgreement agreement, Task& task, Signal signal, Nanoseconds now) noexcept {
  const Method method = signal == Signal::kSpawn ? Method::kInit : Method::kKill;
  const bool is_here = !created_.is_under_way(task.id) && !parts_.set.slow().takes(method);
  if (is_here && waits_for_gap(task, method, now)) return StepEnd::kWaits;
  parts_.set.constants().put_in_force(order_.constants_after());
  const StepEnd end =
      created_.carry_out(task, signal, [&](Task& each, Signal which) { (void)move(each, which, now); });
  if (end == StepEnd::kFailed) return fail(agreement, NoSwitch::kStepFailed, task);
  return end;
}

// The switch is aborted at a step of this context that may be under way: `left` steps are to be undone. False: later.
bool SlowSwitch::leave(std::size_t done, std::size_t& left, Nanoseconds now) noexcept {
  if (done >= steps_.size() || !is_mine(done)) return true;
  Task& each = task(steps_[done].task);
  if (steps_[done].act == SlowAct::kOn && each.is_half_on) {
    if (!parts_.threads.claim(each.id)) return false;
    (void)move(each, Signal::kOff, now);
  }
  if (steps_[done].act != SlowAct::kKill && steps_[done].act != SlowAct::kSpawn) return true;
  const Signal signal = steps_[done].act == SlowAct::kKill ? Signal::kKill : Signal::kSpawn;
  const StepEnd end = created_.cut(each, signal);
  if (end == StepEnd::kDone) left = done + 1;
  return end != StepEnd::kWaits;
}

// No job of who leaves is left that could delay one, directly or by others: the processor of this context is idle once.
bool SlowSwitch::waits_for_idle(Nanoseconds now) noexcept {
  if ((order_.slow & kSlowForDeadlines) == 0 || was_idle_) return false;
  for (const Task& each : parts_.set.tasks()) {
    if (!parts_.set.is_mine(each.id) || !parts_.threads.has_job_before(each.id, now)) continue;
    parts_.threads.await_job(each.id);
    return true;
  }
  was_idle_ = true;
  return false;
}

// Who is initialised with what is in force by now is left as it is.
StepEnd SlowSwitch::reinit(SwitchAgreement agreement, Task& task, Nanoseconds now) noexcept {
  ContextConstants& constants = parts_.set.constants();
  constants.read_foreign();
  constants.put_in_force(order_.constants_after());
  if (!constants.uses_changed(task.id)) return StepEnd::kDone;
  if (waits_for_gap(task, Method::kReinit, now)) return StepEnd::kWaits;
  const State before = task.state;
  const std::uint64_t faults = task.faults.count;
  (void)move(task, Signal::kReinit, now);
  if (task.state == before && task.faults.count == faults) {
    parts_.record.reinitialised(task.id);
    return StepEnd::kDone;
  }
  (void)fail(agreement, NoSwitch::kStepFailed, task);
  constants.put_in_force(order_.constants);
  if (task.state == before) (void)move(task, Signal::kReinit, now);
  return StepEnd::kFailed;
}

// Until the next period of the task, or the deadline.
StepEnd SlowSwitch::wait_a_cycle(const Task& task, Nanoseconds now) noexcept {
  const Nanoseconds period = task.spec->aperiodic ? milliseconds(1) : task.spec->period;
  wake_ = now < order_.until ? std::min(now + period, order_.until) : now + period;
  return StepEnd::kWaits;
}

StepEnd SlowSwitch::turn_on(SwitchAgreement agreement, Task& task, Nanoseconds now) noexcept {
  TaskSet& set = parts_.set;
  set.constants().put_in_force(order_.constants_after());
  set.sources().follow_others();
  if (missing_value(set, task, {}).is_valid()) return wait_a_cycle(task, now);
  if (waits_for_idle(now)) return StepEnd::kWaits;
  if (waits_for_gap(task, Method::kOn, now)) return StepEnd::kWaits;
  const Nanoseconds began = parts_.clock.now();
  const SignalReport report = move(task, Signal::kOn, now);
  parts_.record.took(task.id, Method::kOn, parts_.clock.now() - began);
  if (report.why == Refusal::kNotYet) return wait_a_cycle(task, now);
  if (task.state != State::kOn) return fail(agreement, NoSwitch::kOnFailed, task);
  parts_.record.receipt().armed = parts_.clock.now();
  const VariablePart* const beyond = parts_.record.arrives(task.id, parts_.clock.now());
  if (beyond != nullptr) abort(agreement, NoSwitch::kStepTooLarge, task.id, beyond->handover.variable);
  return StepEnd::kDone;  // what is done is undone as all others
}

// A device that needs some time on the way back has it, for as long as a switch has by default.
StepEnd SlowSwitch::turn_on_again(Task& task, Nanoseconds now) noexcept {
  const SignalReport report = move(task, Signal::kOn, now);
  if (report.why != Refusal::kNotYet) return StepEnd::kDone;
  if (back_until_ == kNever) back_until_ = now + TaskLife::kPatience;
  if (now < back_until_) return wait_a_cycle(task, now);
  (void)move(task, Signal::kOff, now);
  return StepEnd::kDone;
}

// What cannot be undone, because a signal or an error came between, is left as it is.
StepEnd SlowSwitch::undo(const SlowStep& step, Nanoseconds now) noexcept {
  Task& each = task(step.task);
  ContextConstants& constants = parts_.set.constants();
  if (each.in_service || !parts_.threads.claim(step.task)) return StepEnd::kWaits;
  constants.read_foreign();
  constants.put_in_force(order_.constants);
  parts_.set.sources().follow_others();
  if (step.act == SlowAct::kOn && each.state == State::kOn) (void)move(each, Signal::kOff, now);
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

}  // namespace chimera
