// SPDX-License-Identifier: Apache-2.0
// Orders a switch from the real-time units and makes one receipt of what they tell.
#include "chimera/manager/switch_coordinator.h"

#include <algorithm>
#include <ctime>
#include <utility>

#include "chimera/control/receipt_json.h"
#include "chimera/control/receipt_text.h"
#include "chimera/control/switch_reason.h"
#include "chimera/runtime/idle_gap.h"

namespace chimera::manager {
namespace {

constexpr Nanoseconds kGrace = milliseconds(500);  // within which the units abort by themselves

bool is_in_range(const TaskPart& part, const ApplicationSpec& spec, std::uint32_t rtpu) {
  return part.task.index < spec.tasks.size() && spec.tasks[part.task.index].rtpu.index == rtpu &&
         part.move <= TaskMove::kStays;
}

bool is_in_range(const VariablePart& part, const ApplicationSpec& spec, std::uint32_t rtpu) {
  const Handover& h = part.handover;
  return h.variable.index < spec.variables.size() && h.to.task.index < spec.tasks.size() &&
         spec.tasks[h.to.task.index].rtpu.index == rtpu &&
         (!h.from.task.is_valid() || h.from.task.index < spec.tasks.size());
}

Nanoseconds later(Nanoseconds a, Nanoseconds b) { return a == kNever ? b : b == kNever ? a : std::max(a, b); }

/// "14:03:07", of the wall clock.
std::string time_of_day(Nanoseconds at) {
  const auto seconds_since = static_cast<std::time_t>(wall_ns(at) / 1'000'000'000);
  std::tm broken_down{};
  char text[16] = "?";
  if (::localtime_r(&seconds_since, &broken_down) != nullptr) std::strftime(text, sizeof text, "%T", &broken_down);
  return text;
}

/// By how long `on` took, as their units show it.
class ShownGaps final : public NeededGaps {
 public:
  explicit ShownGaps(const ManagerState& world) : world_(world) {}
  Nanoseconds for_on(TaskId task) const noexcept override {
    const TaskSpec& spec = world_.spec().tasks[task.index];
    const PeerSegment& there = world_.peers.of(task);
    const bool is_needed = there.is_there() && !world_.spec().rtpus[spec.rtpu.index].preemptive;
    return is_needed ? IdleGap::needed(spec, world_.profile(task), Method::kOn) : Nanoseconds{};
  }

 private:
  const ManagerState& world_;
};

/// What producers made, as their units show it.
class ShownConstants final : public MadeConstants {
 public:
  explicit ShownConstants(const ManagerState& world) : world_(world) {}
  bool differ(ConstantId constant, std::uint32_t a, std::uint32_t b) const noexcept override {
    const std::vector<std::byte> one = value(constant, a), other = value(constant, b);
    return one.empty() || one != other;
  }

 private:
  std::vector<std::byte> value(ConstantId constant, std::uint32_t producer) const {
    const TaskId task = world_.spec().constants[constant.index].producers[producer].task;
    const PeerLayout& layout = world_.peers.layout(world_.spec().tasks[task.index].rtpu);
    const GroupId group = layout.constants(task);
    if (!world_.peers.of(task).is_there()) return {};
    std::vector<std::byte> payload(layout.place(group).payload_bytes);
    chimera_slot slot;
    const GroupReader reader = world_.peers.of(task).group(group);
    if (!reader.is_bound() || !reader.try_read(slot, payload.data()) || slot.sequence == 0) return {};
    std::size_t i = 0;
    for (const PortSpec& port : world_.spec().tasks[task.index].ports) {
      if (port.kind != CHIMERA_OUT_CONST) continue;
      const std::byte* const at = payload.data() + layout.variables(group)[i++].offset;
      if (port.constant == constant) return {at, at + port.max_bytes()};
    }
    return {};
  }

  const ManagerState& world_;
};

/// It may have been left by a manager that wrote where it should not.
bool is_cause(const BegunSwitch& begun, const ApplicationSpec& spec) {
  const bool is_of_task = begun.cause > SwitchCause::kScript && begun.cause <= SwitchCause::kFault;
  return is_of_task ? begun.by.index < spec.tasks.size() : begun.cause == SwitchCause::kScript && !begun.by.is_valid();
}

bool is_way(const SwitchWay& way, const ApplicationSpec& spec) {
  const auto is_task = [&](TaskId task) { return !task.is_valid() || task.index < spec.tasks.size(); };
  const ConstantUsers::Found& found = way.constant;
  return way.slow <= kSlowReasons && is_task(found.task) && is_task(way.deadline.task) && is_task(way.gapless) &&
         is_task(way.absent) && is_task(way.rival) &&
         (!found.task.is_valid() || found.constant.index < spec.constants.size());
}

std::string asker_text(const BegunSwitch& begun, const ApplicationSpec& spec) {
  if (begun.cause == SwitchCause::kScript) return begun.asked_by.text();
  return control::asked_by({begun.order.after, begun.cause, begun.by}, spec);
}

}  // namespace

// One of those tasks has a resource of `task`.
static bool has_rival_in(const ManagerState& world, TaskId task, const TaskBits& tasks) {
  for (std::size_t t = 0; t < world.spec().tasks.size(); ++t)
    if (tasks.has(TaskId(t)) && world.rivals.are(task, TaskId(t))) return true;
  return false;
}

TaskStatus last_status(const ManagerState& world, TaskId task) {
  TaskStatus status = world.peers.status(task);
  SwitchAgreement agreement(world.page.switching, world.keeper.origin);
  const PlanWord plan = agreement.plan();
  const RtpuId rtpu = world.spec().tasks[task.index].rtpu;
  const auto order = agreement.order(plan, world.spec().sets.size(), world.spec().tasks.size());
  const bool was_member = order && ((order->members >> rtpu.index) & 1u) != 0;
  if (!was_member || !world.peers[rtpu].is_there()) return status;
  const SwitchProgress& progress = world.peers[rtpu].block().head().switching;
  if (progress.adopted.load(std::memory_order_acquire) == plan.number) return status;  // SwitchProgress
  if (plan.phase != SwitchPhase::kCommitted) {  // of a slow one it may have done a part
    if (order->slow != 0 && status.state <= State::kOn)
      status.state = order->on.has(task) ? State::kOn : std::min(status.state, State::kOff);
    if (order->slow != 0 && has_rival_in(world, task, order->on)) status.state = State::kNotCreated;
    return status;
  }
  const bool is_after = order->target.has(task);
  if (is_after && status.state == State::kOff) status.state = State::kOn;
  if (!is_after && status.state == State::kOn) status.state = State::kOff;
  return status;
}

void abort_open_plan_of(ManagerState& world, RtpuId rtpu) {
  SwitchAgreement agreement(world.page.switching, world.keeper.origin);
  const PlanWord plan = agreement.plan();
  if (!plan.is_open()) return;
  const auto order = agreement.order(plan, world.spec().sets.size(), world.spec().tasks.size());
  const bool is_member = order && ((order->members >> rtpu.index) & 1u) != 0;
  if (is_member && agreement.abort(plan.number)) world.announce();
}

SwitchCoordinator::SwitchCoordinator(ManagerState& world, ReceiptArchive& archive)
    : world_(world),
      archive_(archive),
      journal_(world.own.block().journal()),
      standing_(world.spec().tasks.size()) {
  planner_.prepare(world.spec(), memory_);
  ways_.prepare(world.spec(), memory_);
  slow_.prepare(world.spec(), memory_);
  take_over();
}

/// What was never announced is forgotten; a try that was not announced is as if only those before it had been made.
void SwitchCoordinator::take_over() {
  auto begun = journal_.begun();
  if (!begun) return;
  const PlanWord plan = agreement().plan();
  const std::size_t n_sets = world_.spec().sets.size();
  const bool is_damaged = begun->order.after != set_of(world_.spec(), begun->order.target) ||
                          (begun->before >= n_sets && begun->before != kNoSet) ||
                          begun->asked_by.role > control::Role::kConfigure ||
                          begun->cancelled_by.role > control::Role::kConfigure || !is_cause(*begun, world_.spec()) ||
                          !is_way(begun->way, world_.spec());
  const bool is_announced = plan.number == begun->order.number;
  if (is_damaged || (!is_announced && begun->tries <= 1)) return journal_.forget();
  if (!is_announced) {
    begun->order.number = plan.number;
    --begun->tries;
  }
  present_ = Present{*begun, {}};
  world_.announce();
}

std::string SwitchCoordinator::under_way() const {
  if (!present_) return "";
  return "switch " + std::to_string(present_->begun.number) + " to " +
         control::set_text(present_->begun.order.after, world_.spec()) + ", asked for by " +
         asker_text(present_->begun, world_.spec());
}

std::string SwitchCoordinator::progress() const {
  const std::string until = ", until " + time_of_day(present_->begun.order.until);
  switch (agreement().plan().phase) {
    case SwitchPhase::kPrepared: return "arming" + until;
    case SwitchPhase::kProposed: return "agreeing" + until;
    case SwitchPhase::kCommitted: return "committed";
    case SwitchPhase::kAborted: return "aborted";
  }
  return "?";
}

// Those that live and serve this manager have done what they have to do.
bool SwitchCoordinator::is_over(std::uint16_t number, std::uint16_t members) const noexcept {
  for (std::uint32_t r = 0; r < world_.peers.n_rtpus(); ++r) {
    if (((members >> r) & 1u) == 0 || !world_.rtpus[r].is_alive || !world_.peers[RtpuId(r)].is_there()) continue;
    const SwitchProgress& progress = world_.peers[RtpuId(r)].block().head().switching;
    if (progress.over.load(std::memory_order_acquire) != number) return false;  // SwitchProgress
  }
  return true;
}

PlanAnswer SwitchCoordinator::judge(const TaskBits& target) {
  for (std::size_t t = 0; t < standing_.size(); ++t) {
    const TaskId task(t);
    const RtpuRecord& rtpu = world_.rtpus[world_.spec().tasks[t].rtpu.index];
    const State state = world_.state(task);
    const bool is_dead = !rtpu.is_alive && state != State::kNotCreated;
    const bool is_away = !rtpu.is_alive || world_.peers.status(task).in_service;  // nothing can be done with it now
    standing_[t] = {is_dead ? State::kError : state, is_away};
  }
  const PlanAnswer answer = planner_.plan(target, standing_, plan_);
  way_ = answer ? ways_.judge(plan_, standing_, constants_in_force(), ShownConstants(world_), ShownGaps(world_))
                : SwitchWay();
  return answer;
}

/// Those of the configuration that was switched to last; at first of the start.
std::uint32_t SwitchCoordinator::constants_in_force() const {
  const PlanWord plan = agreement().plan();
  const auto order = agreement().order(plan, world_.spec().sets.size(), world_.spec().tasks.size());
  if (!order) return set_of_start(world_.spec());
  return plan.phase == SwitchPhase::kCommitted ? order->constants_after() : order->constants;
}

Nanoseconds SwitchCoordinator::lead() const noexcept {
  Nanoseconds longest;
  for (std::size_t t = 0; t < standing_.size(); ++t) {
    if (standing_[t].state != State::kOn) continue;
    const Profile profile = world_.profile(TaskId(t));
    longest = std::max(longest, profile.execution[static_cast<int>(Method::kCycle)].max);
  }
  return lead_of(plan_, world_.spec().tasks, longest);
}

SwitchOrder SwitchCoordinator::make_order(const TaskBits& target, std::uint8_t slow, Nanoseconds until) const {
  SwitchOrder order;
  order.number = next_plan(agreement().plan().number);
  for (std::uint32_t r = 0; r < world_.peers.n_rtpus(); ++r)
    if (world_.rtpus[r].is_alive) order.members = static_cast<std::uint16_t>(order.members | 1u << r);
  order.after = plan_.after;
  order.target = target;
  order.slow = slow;
  order.constants = constants_in_force();
  order.until = until;
  order.lead = lead();
  for (std::size_t t = 0; t < standing_.size(); ++t)
    if (standing_[t].state == State::kOn) order.on.add(TaskId(t));
  return order;
}

void SwitchCoordinator::announce(const SwitchOrder& order) {
  agreement().announce(order);
  world_.announce();
}

bool SwitchCoordinator::is_free() const noexcept {
  const PlanWord open = agreement().plan();
  return !present_ && !open.is_open() && (open.number == 0 || is_over(open.number, UINT16_MAX));
}

/// What may begin is kDone, for as long as nothing has gone wrong.
void SwitchCoordinator::assess(const TaskBits& target, SwitchOutcome& outcome) {
  SwitchReceipt& receipt = outcome.receipt;
  const PlanAnswer answer = judge(target);
  receipt.before = planner_.set_in_force(standing_);
  receipt.after = set_of(world_.spec(), target);
  receipt.why = answer.why;
  receipt.task = answer.task;
  receipt.way = way_;
  if (present_) {
    receipt.said.assign(under_way() + ", is under way: " + progress());
  } else if (!is_free()) {
    receipt.said.assign("the real-time units are not done with the last switch");
  } else if (!world_.logic.is_settled()) {
    receipt.said.assign("tasks are being brought up");
    outcome.remedy = "`chimera status` shows which; ask again when they are ON";
  }
  if (!receipt.said.view().empty()) {
    receipt.why = NoSwitch::kUnderWay;
    receipt.task = {};
  }
  const bool is_in_force = receipt.why == NoSwitch::kNothingToDo;
  const bool may_begin = receipt.why == NoSwitch::kNone;
  if (!may_begin) receipt.way.slow = 0;
  receipt.end = may_begin ? SwitchEnd::kDone : is_in_force ? SwitchEnd::kNothingToDo : SwitchEnd::kRefused;
  const std::string task = receipt.task.is_valid() ? world_.name(receipt.task) : "";
  if (receipt.why == NoSwitch::kInError) outcome.remedy = "`chimera clear " + task + "`";
  if (receipt.why == NoSwitch::kNotCreated) outcome.remedy = "`chimera spawn " + task + "`";
}

ForeseenSwitch SwitchCoordinator::foresee(const TaskBits& target) {
  SwitchOutcome outcome;
  assess(target, outcome);
  const bool has_plan = outcome.receipt.end == SwitchEnd::kDone;
  return {outcome.receipt, has_plan ? plan_ : SwitchPlan{}, outcome.remedy, has_plan ? expected() : Nanoseconds{}};
}

/// Of methods that were never called: as IdleGap takes them.
Nanoseconds SwitchCoordinator::method_time(TaskId task, Method method) const {
  const Nanoseconds budget = world_.spec().tasks[task.index].budget;
  const Nanoseconds guess = budget > Nanoseconds{} ? budget : IdleGap::kUnknownMethod;
  const Profile profile = world_.profile(task);
  return profile.execution[static_cast<int>(method)].count == 0 ? guess : profile.of_late(method);
}

/// To the change, when nothing has to be waited for but the flag. Requires: plan_ and way_ were judged.
Nanoseconds SwitchCoordinator::expected() {
  Nanoseconds sum;
  if (way_.slow == 0) {
    for (const TaskId task : plan_.arriving) sum = sum + method_time(task, Method::kOn);
    return sum + lead();
  }
  const Method methods[] = {Method::kCycle, Method::kOff, Method::kKill, Method::kInit, Method::kReinit, Method::kOn};
  static_assert(std::size(methods) == static_cast<std::size_t>(SlowAct::kOn) + 1);
  for (const SlowStep& step : slow_.plan(plan_, constants_in_force(), way_.slow))
    if (step.act != SlowAct::kCheck) sum = sum + method_time(step.task, methods[static_cast<int>(step.act)]);
  const TaskBits on = make_order(target_of(plan_), way_.slow, {}).on;
  return (way_.slow & kSlowForConstants) != 0 ? sum + flag_lead(world_.spec(), on) : sum;
}

void SwitchCoordinator::ask(const SwitchRequest& request, const TaskBits& target, Asker asked_by, Nanoseconds wait,
                            Nanoseconds now, Switched switched) {
  look(now);
  auto outcome = std::make_shared<SwitchOutcome>();
  assess(target, *outcome);
  outcome->receipt.asked = now;
  outcome->receipt.cause = request.cause;
  outcome->receipt.by = request.by;
  BegunSwitch begun;
  begun.number = journal_.next();
  begun.before = outcome->receipt.before;
  begun.cause = request.cause;
  begun.by = request.by;
  begun.asked_by = asked_by;
  begun.asked = now;
  if (outcome->receipt.end == SwitchEnd::kNothingToDo) return switched(*outcome);
  if (outcome->receipt.end == SwitchEnd::kRefused) {
    outcome->receipt.number = begun.number;
    std::vector<Switched> one;
    one.push_back(std::move(switched));
    return file(std::move(outcome), begun, now, std::move(one));
  }
  begun.way = way_;
  begun.order = make_order(target, way_.slow, now + wait);
  journal_.begin(begun);
  present_ = Present{begun, {}};
  present_->switched.push_back(std::move(switched));
  announce(begun.order);
  world_.tell("switch", TaskId{}, RtpuId{}, under_way() + ": begun", now);
}

/// Who cancelled is noted before the plan is aborted: a successor may have to tell.
bool SwitchCoordinator::cancel(Asker cancelled_by, Switched switched) {
  if (!present_) return false;
  BegunSwitch cancelled = present_->begun;
  cancelled.cancelled_by = cancelled_by;
  journal_.change(cancelled);
  if (!agreement().abort(cancelled.order.number)) {
    journal_.change(present_->begun);
    return false;
  }
  present_->begun = cancelled;
  present_->switched.push_back(std::move(switched));
  world_.announce();
  return true;
}

Nanoseconds SwitchCoordinator::next_due() const noexcept {
  const bool is_open = present_ && agreement().plan().is_open();  // when it is not, units ring
  return is_open ? present_->begun.order.until + kGrace : kNever;
}

/// Of one that was only late, and that nobody has cancelled: it has more time then.
bool SwitchCoordinator::is_tried_again(const SwitchReceipt& receipt, Nanoseconds now) {
  BegunSwitch& begun = present_->begun;
  const std::uint8_t slow = begun.order.slow == 0 ? reason_to_go_slowly(receipt.why) : 0;
  const bool was_late = receipt.why == NoSwitch::kLate && now < begun.order.until;
  const bool is_cancelled = begun.cancelled_by.role != control::Role::kNone;
  if ((!was_late && slow == 0) || is_cancelled || world_.is_ending()) return false;
  if (begun.tries >= kMostTries || !judge(begun.order.target)) return false;
  ++begun.tries;
  if (slow != 0) begun.way.slow = slow;
  const Nanoseconds until = slow != 0 ? now + (begun.order.until - begun.asked) : begun.order.until;
  begun.order = make_order(begun.order.target, begun.way.slow, until);
  begun.order.lead = lead_of_try(begun.order.lead, begun.tries);
  journal_.change(begun);
  announce(begun.order);
  return true;
}

/// An open plan of which the journal knows nothing is nobody's.
void SwitchCoordinator::look(Nanoseconds now) {
  const PlanWord plan = agreement().plan();
  if (!present_ && plan.is_open() && agreement().abort(plan.number)) world_.announce();
  if (!present_) return;
  const SwitchOrder& order = present_->begun.order;
  const bool is_due = now >= order.until + kGrace || world_.is_ending();
  if (is_due && agreement().abort(order.number)) world_.announce();
  if (agreement().plan().is_open() || !is_over(order.number, order.members)) return;
  auto outcome = collect(present_->begun, now);
  if (is_tried_again(outcome->receipt, now)) return;
  const Present over = *std::exchange(present_, std::nullopt);
  tell(*outcome, now);
  file(std::move(outcome), over.begun, now, over.switched);
}

/// A part says anything when its unit has died: what does not fit the application is left out.
void SwitchCoordinator::add_part(const SwitchPart& part, std::uint32_t rtpu, Nanoseconds now,
                                 SwitchOutcome& outcome) const {
  const ApplicationSpec& spec = world_.spec();
  SwitchReceipt& receipt = outcome.receipt;
  const auto is_possible = [&](Nanoseconds at) { return at >= receipt.asked && at <= now; };
  if (is_possible(part.armed)) receipt.armed = later(receipt.armed, part.armed);
  if (part.flag > Nanoseconds{} && part.flag <= now - receipt.asked) receipt.flag = std::max(receipt.flag, part.flag);
  const auto is_its = [&](TaskId task) {
    return task.index < spec.tasks.size() && spec.tasks[task.index].rtpu.index == rtpu;
  };
  if (is_its(part.not_back)) receipt.not_back = part.not_back;
  for (std::uint32_t i = 0; i < std::min<std::size_t>(part.n_reinitialised, part.reinitialised.size()); ++i)
    if (is_its(part.reinitialised[i])) outcome.reinitialised.push_back(part.reinitialised[i]);
  if (is_possible(part.ended)) receipt.ended = later(receipt.ended, part.ended);
  const bool says_more = receipt.why == NoSwitch::kNone || is_of_another(receipt.why);
  if (part.why != NoSwitch::kNone && says_more && receipt.end == SwitchEnd::kAborted) {
    receipt.why = part.why;
    if (part.task.index < spec.tasks.size()) receipt.task = part.task;
    if (part.variable.index < spec.variables.size()) receipt.variable = part.variable;
    receipt.value = part.value;
    receipt.said.assign({part.said, ::strnlen(part.said, SwitchPart::kSaid)});
  }
  for (std::uint32_t i = 0; i < std::min<std::size_t>(part.n_tasks, part.tasks.size()); ++i)
    if (is_in_range(part.tasks[i], spec, rtpu)) outcome.tasks.push_back(part.tasks[i]);
  for (std::uint32_t i = 0; i < std::min(part.n_variables, SwitchPart::kVariablesKept); ++i)
    if (is_in_range(part.variables[i], spec, rtpu)) outcome.variables.push_back(part.variables[i]);
}

std::shared_ptr<SwitchOutcome> SwitchCoordinator::collect(const BegunSwitch& over, Nanoseconds now) const {
  const PlanWord word = agreement().plan();
  const bool is_committed = word.number == over.order.number && word.phase == SwitchPhase::kCommitted;
  auto outcome = std::make_shared<SwitchOutcome>();
  SwitchReceipt& receipt = outcome->receipt;
  receipt.number = over.number;
  receipt.before = over.before;
  receipt.after = over.order.after;
  receipt.asked = over.asked;
  receipt.cause = over.cause;
  receipt.by = over.by;
  receipt.way = over.way;
  receipt.tries = over.tries;
  receipt.end = is_committed ? SwitchEnd::kDone : SwitchEnd::kAborted;
  if (is_committed) receipt.at = agreement().at(word);
  for (std::uint32_t r = 0; r < world_.peers.n_rtpus(); ++r) {
    if (((over.order.members >> r) & 1u) == 0 || !world_.peers[RtpuId(r)].is_there()) continue;
    const SwitchPart& part = world_.peers[RtpuId(r)].block().switch_part();
    if (part.number == over.order.number) add_part(part, r, now, *outcome);
  }
  if (receipt.ended == kNever) receipt.ended = now;
  if (over.cancelled_by.role != control::Role::kNone && !is_committed) {
    receipt.why = NoSwitch::kCancelled;
    receipt.said.assign(over.cancelled_by.text());
  } else if (!is_committed && receipt.why == NoSwitch::kNone) {
    receipt.why = world_.is_ending() ? NoSwitch::kRunEnded : NoSwitch::kMemberDied;
  }
  std::ranges::stable_sort(outcome->tasks, {}, &TaskPart::move);
  const std::span<const TaskId> order = world_.spec().init_order;
  const auto place = [order](TaskId task) { return std::ranges::find(order, task) - order.begin(); };
  std::ranges::sort(outcome->reinitialised, {}, place);
  receipt.reinitialised = outcome->reinitialised;
  receipt.tasks = outcome->tasks;
  receipt.variables = outcome->variables;
  return outcome;
}

void SwitchCoordinator::file(std::shared_ptr<SwitchOutcome> outcome, const BegunSwitch& of, Nanoseconds now,
                             std::vector<Switched> switched) {
  outcome->json = control::receipt_json(outcome->receipt, world_.spec(), world_.keeper.origin,
                                        {asker_text(of, world_.spec()), wall_ns(of.asked)});
  archive_.add(of.number, outcome->json, now, [outcome, switched = std::move(switched)] {
    for (const Switched& one : switched) one(*outcome);
  });
}

void SwitchCoordinator::tell(const SwitchOutcome& outcome, Nanoseconds now) {
  const ApplicationSpec& spec = world_.spec();
  const std::string text = control::receipt_text(outcome.receipt, spec, world_.keeper.origin);
  world_.tell("switch", TaskId{}, RtpuId{}, text.substr(0, text.find('\n')), now);
  for (const std::string& line : control::bump_lines(outcome.receipt, spec))
    world_.tell("bump", TaskId{}, RtpuId{}, line, now);
}

}  // namespace chimera::manager
