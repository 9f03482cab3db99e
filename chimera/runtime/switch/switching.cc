// SPDX-License-Identifier: Apache-2.0
// Carries out a switch in one context: arms, agrees, changes at one instant, turns OFF, and writes the receipt.
#include "chimera/runtime/switch/switching.h"

#include <algorithm>

#include "chimera/base/assert.h"
#include "chimera/runtime/switch/present_value.h"
#include "chimera/runtime/switch/switch_orders.h"

namespace chimera {
namespace {

void note_statuses(const TaskSet& set, std::span<TaskStatus> statuses) noexcept {
  for (const Task& each : set.tasks()) {
    const bool is_elsewhere = set.others() != nullptr && !set.is_mine(each.id);
    statuses[each.id.index] = {is_elsewhere ? set.others()->state(each.id) : each.shown_state(), each.in_service()};
  }
}

// This context arms next. If no task arrives, the member with the lowest number has the turn.
bool is_turn_of(const TaskSet& set, const SwitchPlan& plan, const SwitchRun& run, std::uint16_t members) noexcept {
  if (set.others() == nullptr) return true;
  if (run.begin < run.end) return set.is_mine(plan.arriving[run.begin]);
  return plan.arriving.empty() && (members & ((1u << set.context()) - 1u)) == 0;
}

// The jobs of all `members` that live use the bindings of that plan.
bool have_adopted(SwitchPeers& peers, std::uint32_t members, std::uint16_t number) noexcept {
  for (std::uint32_t context = 0; context < kMaxContexts; ++context) {
    if (((members & peers.living()) >> context & 1u) == 0) continue;
    const SwitchProgress* progress = peers.progress(context);
    if (progress == nullptr || progress->adopted.load(std::memory_order_acquire) != number) return false;
  }
  return true;
}

}  // namespace

Switching::Switching(const Parts& parts) noexcept
    : parts_(parts),
      gap_(parts.set.tasks(), parts.queue, parts.threads),
      changeover_(parts.set, parts.queue, parts.threads, parts.members, parts.misses, parts.tap),
      slow_({parts.set, parts.threads, parts.settlement, parts.tap, parts.clock, gap_, record_}),
      record_(parts.set) {}

void Switching::prepare(SwitchPeers* peers) {
  if (peers == nullptr) return;
  TaskSet& set = parts_.set;
  CHIMERA_ASSERT(set.spec().tasks.size() <= kMaxSwitchedTasks);
  peers_ = peers;
  me_ = set.others() == nullptr ? 0 : set.context();
  slow_.prepare();
  planner_.prepare(set.spec(), set.setup_memory());
  record_.prepare();
  changeover_.prepare();
  statuses_ = set.setup_memory().take<TaskStatus>(set.tasks().size());
}

// An earlier incarnation of this context may have taken part in the open plan; this one knows nothing of the plan.
void Switching::begin(Nanoseconds origin) noexcept {
  origin_ = origin;
  if (peers_ == nullptr) return;
  const PlanWord plan = agreement().plan();
  seen_ = plan.number;
  if (seen_ == 0) return;
  const auto last = agreement().order(plan, parts_.set.spec().sets.size(), parts_.set.tasks().size());
  const bool is_after = plan.phase == SwitchPhase::kCommitted;
  if (last) parts_.set.constants().put_in_force(is_after ? last->constants_after() : last->constants);
  record_.restart().number = seen_;
  record_.receipt().tasks = {};
  record_.receipt().variables = {};
  record_.receipt().end = SwitchEnd::kAborted;
  if (agreement().abort(seen_)) record_.receipt().why = NoSwitch::kMemberDied;
  peers_->tell_over(record_.receipt());
}

bool Switching::is_free() const noexcept {
  if (phase_ == Phase::kNone) return peers_ == nullptr || agreement().plan().number == seen_;
  return phase_ == Phase::kAfter && n_off_ == plan_.leaving.size();
}

// A plan that this context has not taken up counts too: another context may have begun.
std::optional<SwitchOrder> Switching::under_way() const noexcept {
  if (peers_ == nullptr) return std::nullopt;
  if (phase_ != Phase::kNone) {
    const bool is_over = !is_held_ && (phase_ == Phase::kAfter || phase_ == Phase::kUndoing);
    return is_over ? std::nullopt : std::optional(order_);
  }
  const PlanWord plan = agreement().plan();
  if (plan.number == seen_ || !plan.is_open()) return std::nullopt;
  return agreement().order(plan, parts_.set.spec().sets.size(), parts_.set.tasks().size());
}

// The request changes nothing if it is for the tasks that are ON, or are being switched to.
bool Switching::ask(const SwitchRequest& request, Nanoseconds now) noexcept {
  const bool has_lists = request.lists.are_there();
  bool changes_nothing = false;
  if (phase_ != Phase::kNone || !is_free()) {
    const auto order = agreement().order(agreement().plan(), parts_.set.spec().sets.size(), statuses_.size());
    const bool leads_there =
        order && (has_lists ? request.lists.are_met_by(order->target) : order->after == request.set);
    changes_nothing = phase_ != Phase::kUndoing && leads_there;
  } else {
    note_statuses(parts_.set, statuses_);
    changes_nothing =
        has_lists ? request.lists.are_met_by(tasks_on(statuses_)) : planner_.set_in_force(statuses_) == request.set;
  }
  peers_->wish(request, changes_nothing, now);
  return !changes_nothing;
}

void Switching::stop_watching(Nanoseconds now) noexcept {
  if (phase_ == Phase::kAfter && is_free()) finish(SwitchEnd::kDone, now);
}

void Switching::step(Nanoseconds edge) noexcept {
  if (peers_ == nullptr) return;
  Nanoseconds now = edge;
  waits_for_row_ = false;
  const PlanWord plan = agreement().plan();
  if (phase_ == Phase::kNone && plan.number != seen_) take_up(plan, now);
  if (phase_ == Phase::kNone) return;
  record_.watch();
  now = std::max(now, parts_.clock.now());  // methods of this cycle boundary took their time
  const bool is_open = phase_ == Phase::kArming || phase_ == Phase::kAgreed;
  if (is_open && (plan.number != order_.number || plan.phase == SwitchPhase::kAborted))
    abort(NoSwitch::kNone, {}, {});  // another context did
  if (phase_ == Phase::kArming) arm(edge, now);
  if (phase_ == Phase::kAgreed) {
    due_ = wake_ = at_;
    const Disturbance found = find_disturbance(parts_.set, plan_, next_armed_, before_, *peers_);
    if (agreement().plan().phase == SwitchPhase::kCommitted) phase_ = Phase::kChanging;
    else if (found) abort(found.why, found.of, {});
    else if (now >= at_) abort(NoSwitch::kLate, {}, {});
  }
  if (phase_ == Phase::kChanging) change(now);
  if (phase_ == Phase::kSlow) go_slowly(now);
  if (phase_ == Phase::kAfter || phase_ == Phase::kUndoing) settle(parts_.clock.now());
}

// Aborts a plan in which this context cannot take part; the plan is over here at once.
void Switching::take_up(const PlanWord& plan, Nanoseconds now) noexcept {
  seen_ = plan.number;
  const auto order = agreement().order(plan, parts_.set.spec().sets.size(), parts_.set.tasks().size());
  SwitchReceipt& receipt = record_.restart();
  receipt.number = plan.number;
  receipt.asked = now;
  const bool is_member = order && ((order->members >> me_) & 1u) != 0;
  bool is_made = plan.is_open() && is_member;
  if (is_made) {
    for (const Task& each : parts_.set.tasks())
      statuses_[each.id.index] = {order->on.has(each.id) ? State::kOn : State::kOff, false};
    is_made = static_cast<bool>(planner_.plan(order->target, statuses_, plan_));
    receipt.before = is_made ? plan_.before : kNoSet;
    receipt.after = order->after;
  }
  if (is_made) {
    order_ = *order;
    record_.take_up(plan_);
    before_ = {order_.on, order_.members, parts_.set.flag().is_up(), parts_.set.flag().is_raised()};
    next_armed_ = n_off_ = 0;
    at_ = gap_since_ = off_since_ = kNever;
    is_changed_ = false;
    phase_ = order_.slow != 0 ? Phase::kSlow : Phase::kArming;
    if (phase_ == Phase::kSlow) slow_.begin(agreement(), plan_, order_, *peers_, me_);
    return;
  }
  receipt.end = SwitchEnd::kAborted;
  receipt.tasks = {};
  receipt.variables = {};
  if (plan.is_open() && agreement().abort(plan.number)) {
    receipt.why = order && !is_member ? NoSwitch::kMemberDied : NoSwitch::kDamaged;
    peers_->ring();
  }
  peers_->tell_over(receipt);
}

void Switching::arm(Nanoseconds edge, Nanoseconds now) noexcept {
  if (agreement().plan().phase == SwitchPhase::kProposed) return agree(now);
  if (!cool_down(parts_.set, parts_.threads, parts_.members, plan_, now)) return wait(now);
  if (!may_go_on(now)) return;
  const auto number = agreement().run(order_.number);
  const SwitchRun run = find_run(plan_, parts_.set.spec().tasks, number.value_or(UINT16_MAX));
  if (!is_turn_of(parts_.set, plan_, run, order_.members)) {
    due_ = wake_ = order_.until + kAbortGrace;
    return;
  }
  // The context that arms first asks before it arms, the last to arm before it proposes.
  const SafeCondition& asked = asked_of(parts_.set.spec(), order_.after);
  if (next_armed_ == 0 && run.begin == 0 && !holds(parts_.set, asked)) return wait(now, kLookForValue);
  for (next_armed_ = std::max(next_armed_, run.begin); next_armed_ < run.end;) {
    Task& next = task(plan_.arriving[next_armed_]);
    if (!has_gap(next, Method::kOn, now)) return wait(now);
    parts_.set.sources().read_ahead(next.id, plan_.handovers, plan_.arriving.first(next_armed_));
    if (missing_value(parts_.set, next, plan_.handovers).is_valid()) return wait(now, kLookForValue);
    if (is_behind(parts_.set, next, order_)) {
      if (!has_gap(next, Method::kReinit, now)) return wait(now);
      const bool is_done = follow_constants(parts_.set, next, order_, now);
      parts_.settlement.record_faults(next);
      if (is_done) record_.reinitialised(next.id);
      else abort(NoSwitch::kStepFailed, next.id, {});
      if (!is_done) record_.receipt().said.assign(next.faults.last.text);
      due_ = wake_ = parts_.clock.now();
      return;
    }
    if (!arm(next, now)) return;
    now = parts_.clock.now();
    record_.receipt().armed = now;
  }
  const Nanoseconds armed = record_.receipt().armed;
  if (armed != kNever && armed > edge) {  // signals that came while tasks were armed go first: one may abort the plan
    due_ = wake_ = now;
    return;
  }
  if (const VariablePart* part = record_.find_too_large_step())
    return abort(NoSwitch::kStepTooLarge, part->handover.to.task, part->handover.variable);
  if (run.end == plan_.arriving.size()) {
    if (holds(parts_.set, asked)) return propose(now);
    return abort(NoSwitch::kNotSafe, {}, asked.variable);
  }
  (void)agreement().hand_on(order_.number, *number);
  peers_->ring();
  due_ = wake_ = parts_.set.others() == nullptr ? now : order_.until + kAbortGrace;  // alone it has each turn
}

// Aborts the switch if a task or a member is not as the plan found it, or if the deadline is over.
bool Switching::may_go_on(Nanoseconds now) noexcept {
  TaskSet& set = parts_.set;
  if (const auto found = find_disturbance(set, plan_, next_armed_, before_, *peers_)) {
    abort(found.why, found.of, {});
    return false;
  }
  const auto number = agreement().run(order_.number);
  const SwitchRun run = find_run(plan_, set.spec().tasks, number.value_or(UINT16_MAX));
  const bool is_mine = is_turn_of(parts_.set, plan_, run, order_.members);
  if (now < order_.until + (is_mine ? Nanoseconds{} : kAbortGrace)) return true;
  const SafeCondition& asked = asked_of(set.spec(), order_.after);
  if (is_mine && next_armed_ == 0 && run.begin == 0 && !holds(parts_.set, asked)) {
    abort(NoSwitch::kNotSafe, {}, asked.variable);
    return false;
  }
  if (!is_mine || std::max(next_armed_, run.begin) >= run.end) {
    abort(is_mine ? NoSwitch::kNoGap : NoSwitch::kNoAnswer, {}, {});
    return false;
  }
  next_armed_ = std::max(next_armed_, run.begin);
  Task& next = task(plan_.arriving[next_armed_]);
  parts_.set.sources().read_ahead(next.id, plan_.handovers, plan_.arriving.first(next_armed_));
  const VariableId missing = missing_value(parts_.set, next, plan_.handovers);
  abort(missing.is_valid() ? NoSwitch::kNoValue : NoSwitch::kNoGap, next.id, missing);
  return false;
}

// Where jobs preempt each other a gap is taken only if it comes soon.
bool Switching::has_gap(const Task& next, Method method, Nanoseconds now) noexcept {
  if (gap_since_ == kNever) gap_since_ = now;
  const bool is_late = parts_.threads.preempt() && now >= gap_since_ + gap_.soon();
  if (!is_late && !gap_.is_for(next, method, now)) return false;
  gap_since_ = kNever;
  return true;
}

bool Switching::arm(Task& next, Nanoseconds now) noexcept {
  ContextConstants& constants = parts_.set.constants();
  const Nanoseconds began = parts_.clock.now();
  constants.put_in_force(order_.constants_after());
  const SignalReport report = parts_.set.life().arm(next.id, now);
  parts_.tap.pass_over(next.id);
  constants.put_in_force(order_.constants);
  parts_.tap.record(TapKind::kSignal, now, next.id, static_cast<std::uint64_t>(Signal::kOn), report ? 1 : 0);
  parts_.settlement.record_faults(next);
  record_.took(next.id, Method::kOn, parts_.clock.now() - began);
  if (report) {
    ++next_armed_;
  } else if (report.why == Refusal::kNotYet) {  // `off` of this task is called with that of the armed tasks
    next.standing = Standing::kOwesOff;
    ++next_armed_;
    abort(NoSwitch::kNotReady, next.id, {});
  } else {
    abort(NoSwitch::kOnFailed, next.id, {});
    record_.receipt().said.assign(next.faults.last.text);
  }
  return static_cast<bool>(report);
}

// Jobs that were released before `now` keep the old bindings.
void Switching::propose(Nanoseconds now) noexcept {
  changeover_.release_before(now);
  const Nanoseconds unused = parts_.threads.latest_release() + Nanoseconds{1};
  const Nanoseconds at = agreement().round_up(std::max(now + order_.lead, unused));
  if (at == kNever) return abort(NoSwitch::kLate, {}, {});
  if (agreement().propose(order_.number, at)) peers_->ring();
  if (agreement().plan().phase == SwitchPhase::kProposed) agree(now);
}

// From here to the change, or to the end, tasks of other contexts count as they were before.
void Switching::agree(Nanoseconds now) noexcept {
  at_ = agreement().at(agreement().plan());
  if (const auto found = find_disturbance(parts_.set, plan_, next_armed_, before_, *peers_))
    return abort(found.why, found.of, {});
  if (now > at_ || parts_.threads.latest_release() >= at_) return abort(NoSwitch::kLate, {}, {});
  changeover_.hold(plan_, order_.on, at_);
  is_held_ = true;
  phase_ = Phase::kAgreed;
  if (agreement().agree(order_.number, me_)) peers_->ring();
}

void Switching::change(Nanoseconds now) noexcept {
  if (now < at_) return;
  changeover_.change_releases(at_, now);
  if (!is_changed_) {
    is_changed_ = true;
    parts_.set.constants().put_in_force(order_.constants_after());
    record_.changed(plan_, at_);
    changeover_.make(plan_, order_.target, at_);
  }
  record_.keep_last_of_leaving();
  if (!changeover_.follow(plan_, at_)) {
    due_ = now;  // at the end of each job, or when no job waits any more
    wake_ = parts_.threads.next_look(now);
    waits_for_row_ = true;
    return;
  }
  phase_ = Phase::kAfter;
  peers_->tell_adopted(order_.number);
}

void Switching::go_slowly(Nanoseconds now) noexcept {
  if (!cool_down(parts_.set, parts_.threads, parts_.members, plan_, now)) return wait(now);
  if (!slow_.step(agreement(), now)) {
    wake_ = std::max(std::min(slow_.wake(), parts_.threads.next_look(now)), now);
    waits_for_row_ = !gap_.is_there();
    due_ = waits_for_row_ ? now : wake_;
    return;
  }
  now = parts_.clock.now();
  if (slow_.end() == SwitchEnd::kAborted) return finish(SwitchEnd::kAborted, now);
  record_.receipt().at = agreement().at(agreement().plan());
  phase_ = Phase::kAfter;
  peers_->tell_adopted(order_.number);
}

// Aborts the plan on the page. A plan that is committed goes on.
void Switching::abort(NoSwitch why, TaskId of, VariableId variable) noexcept {
  if (agreement().abort(order_.number)) {
    record_.receipt().why = why;
    record_.receipt().task = of;
    record_.receipt().variable = variable;
    if (why == NoSwitch::kNotSafe)
      record_.receipt().value = present_value(parts_.set, asked_of(parts_.set.spec(), order_.after));
    peers_->ring();
  } else if (const PlanWord plan = agreement().plan();
             plan.number == order_.number && plan.phase == SwitchPhase::kCommitted) {
    return;
  }
  for (const TaskId id : plan_.arriving)
    if (parts_.set.is_mine(id) && task(id).standing == Standing::kOwesOff) task(id).forget_sent();
  phase_ = Phase::kUndoing;
}

void Switching::settle(Nanoseconds now) noexcept {
  const bool undoes = phase_ == Phase::kUndoing;
  if (!undoes && is_held_ && !have_adopted(*peers_, order_.members & ~(1u << me_), order_.number)) {
    due_ = wake_ = kNever;  // the other members ring
    return;
  }
  if (is_held_) changeover_.release();
  is_held_ = false;
  const bool has_seen = undoes || record_.has_seen_first_cycles(now);
  if (!turn_off_all(now, false)) return wait(now);
  now = parts_.clock.now();
  if (undoes) return finish(SwitchEnd::kAborted, now);
  if (has_seen || peers_->is_wish_open()) return finish(SwitchEnd::kDone, now);
  record_.await_first_cycles(parts_.threads);
  due_ = now;
  wake_ = record_.first_cycles_by();
  waits_for_row_ = true;
}

// Calls `off` of leaving tasks, or of tasks armed in vain, each in a gap unless `at_once`. False: some tasks wait for
// the next gap.
bool Switching::turn_off_all(Nanoseconds now, bool at_once) noexcept {
  const bool undoes = phase_ == Phase::kUndoing;
  const std::size_t n = undoes ? next_armed_ : plan_.leaving.size();
  if (off_since_ == kNever) off_since_ = now;
  for (; n_off_ < n; ++n_off_) {
    Task& next = task(undoes ? plan_.arriving[n - 1 - n_off_] : plan_.leaving[n_off_]);
    // A task of another context, or a signal has turned the task OFF before.
    if (!parts_.set.is_mine(next.id) || next.standing != Standing::kOwesOff) continue;
    const Nanoseconds most = parts_.threads.preempt() ? gap_.soon() : IdleGap::kLongestWait;
    const bool may_wait = !at_once && now < off_since_ + most;
    if (may_wait && !gap_.is_for(next, Method::kOff, now)) return false;
    const Nanoseconds began = parts_.clock.now();
    const SignalReport report = parts_.set.life().settle_off(next.id, now);
    now = parts_.clock.now();
    parts_.tap.record(TapKind::kSignal, began, next.id, static_cast<std::uint64_t>(Signal::kOff), report ? 1 : 0);
    parts_.settlement.record_faults(next);
    record_.took(next.id, Method::kOff, now - began);
  }
  return true;
}

void Switching::finish(SwitchEnd end, Nanoseconds now) noexcept {
  record_.end(end, now);
  for (const TaskId id : plan_.arriving) {
    const bool is_off = parts_.set.is_mine(id) && task(id).state == State::kOff;
    if (end != SwitchEnd::kDone && is_off) parts_.set.sources().read_ahead(id, {}, {});
  }
  phase_ = Phase::kNone;
  due_ = wake_ = kNever;
  peers_->tell_over(record_.receipt());
}

bool Switching::give_way(TaskId to) noexcept {
  if (phase_ == Phase::kNone && under_way()) return false;
  if (phase_ == Phase::kSlow) slow_.abort(agreement(), NoSwitch::kDisturbed, to, {});
  if (phase_ == Phase::kArming || phase_ == Phase::kAgreed) abort(NoSwitch::kDisturbed, to, {});
  if (phase_ == Phase::kUndoing && is_held_) {
    changeover_.release();
    is_held_ = false;
  }
  return !is_held_ && phase_ != Phase::kSlow;
}

void Switching::end(Nanoseconds now) noexcept {
  if (phase_ == Phase::kNone) return;
  if (phase_ == Phase::kArming || phase_ == Phase::kAgreed) abort(NoSwitch::kRunEnded, {}, {});
  if (phase_ == Phase::kSlow) {
    slow_.cut(agreement());
    return finish(slow_.end(), parts_.clock.now());
  }
  const bool was_committed = phase_ != Phase::kUndoing;
  if (was_committed && !is_changed_) change(at_);
  if (is_held_) changeover_.release();
  is_held_ = false;
  if (was_committed) (void)record_.has_seen_first_cycles(now);
  (void)turn_off_all(now, true);
  finish(was_committed ? SwitchEnd::kDone : SwitchEnd::kAborted, parts_.clock.now());
}

// The next step is due when jobs have ended, or at the next release if the processor is idle. Where jobs preempt each
// other only a value is waited for.
void Switching::wait(Nanoseconds now, Nanoseconds at_most) noexcept {
  const Nanoseconds limit = std::max(order_.until, now + Nanoseconds{1});
  const Nanoseconds next = std::max(parts_.threads.next_look(now), now);
  wake_ = std::min({next, limit, at_most == kNever ? kNever : now + at_most});
  waits_for_row_ = !gap_.is_there();
  due_ = waits_for_row_ ? now : wake_;
}

}  // namespace chimera
