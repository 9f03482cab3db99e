// SPDX-License-Identifier: Apache-2.0
// Orders a switch from the real-time units and makes one receipt of what they tell.
#include "chimera/manager/switch_coordinator.h"

#include <algorithm>

#include "chimera/control/receipt_text.h"

namespace chimera::manager {
namespace {

constexpr Nanoseconds kLeastLead = milliseconds(1), kBeyondLongestJob = microseconds(200);
constexpr Nanoseconds kGrace = milliseconds(500);  // within which the units abort by themselves
constexpr int kMostTries = 3;                      // of a switch that was only too late

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

}  // namespace

TaskStatus last_status(const ManagerState& world, TaskId task) {
  TaskStatus status = world.peers.status(task);
  SwitchAgreement agreement(world.page.switching, world.keeper.origin);
  const PlanWord plan = agreement.plan();
  const RtpuId rtpu = world.spec().tasks[task.index].rtpu;
  const auto order = agreement.order(plan, world.spec().sets.size(), world.spec().tasks.size());
  const bool was_member = order && ((order->members >> rtpu.index) & 1u) != 0;
  if (plan.phase != SwitchPhase::kCommitted || !was_member || !world.peers[rtpu].is_there()) return status;
  const SwitchProgress& progress = world.peers[rtpu].block().head().switching;
  if (progress.adopted.load(std::memory_order_acquire) == plan.number) return status;  // SwitchProgress
  const bool is_after = order->target.has(task);
  if (is_after && status.state == State::kOff) status.state = State::kOn;
  if (!is_after && status.state == State::kOn) status.state = State::kOff;
  return status;
}

SwitchCoordinator::SwitchCoordinator(ManagerState& world) : world_(world), standing_(world.spec().tasks.size()) {
  planner_.prepare(world.spec(), memory_);
}

std::string SwitchCoordinator::under_way() const {
  if (!present_) return "";
  return "switch " + std::to_string(present_->order.number) + " to " +
         control::set_text(present_->order.after, world_.spec()) + ", asked for by " + present_->asked_by;
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
    standing_[t] = {is_dead ? State::kError : state, world_.peers.status(task).in_service};
  }
  return planner_.plan(target, standing_, plan_);
}

Nanoseconds SwitchCoordinator::lead() const noexcept {
  Nanoseconds longest;
  for (std::size_t t = 0; t < standing_.size(); ++t) {
    const PeerSegment& there = world_.peers.of(TaskId(t));
    if (standing_[t].state != State::kOn || !there.is_there()) continue;
    const Profile profile = there.block().profile(TaskId(t));
    longest = std::max(longest, profile.execution[static_cast<int>(Method::kCycle)].max);
  }
  return std::max(kLeastLead, longest + kBeyondLongestJob);
}

// Of the plan that was judged last.
SwitchOrder SwitchCoordinator::make_order(const TaskBits& target, Nanoseconds wait, Nanoseconds now) {
  SwitchOrder order;
  order.number = next_plan(agreement().plan().number);
  for (std::uint32_t r = 0; r < world_.peers.n_rtpus(); ++r)
    if (world_.rtpus[r].is_alive) order.members = static_cast<std::uint16_t>(order.members | 1u << r);
  order.after = plan_.after;
  order.target = target;
  order.until = now + wait;
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

void SwitchCoordinator::ask(const SwitchRequest& request, const TaskBits& target, std::string asked_by,
                            Nanoseconds wait, Nanoseconds now, Switched switched) {
  SwitchOutcome refused;
  refused.asked_by = asked_by;
  refused.receipt.asked = now;
  refused.receipt.after = request.set;
  refused.receipt.cause = request.cause;
  refused.receipt.by = request.by;
  look(now);
  PlanAnswer answer{NoSwitch::kUnderWay, {}};
  if (is_free()) answer = judge(target);
  if (!answer) {
    const bool is_in_force = answer.why == NoSwitch::kNothingToDo;
    if (answer.why == NoSwitch::kUnderWay)
      refused.under_way = present_ ? under_way() : "a switch that a manager before this one has ordered";
    refused.receipt.end = is_in_force ? SwitchEnd::kNothingToDo : SwitchEnd::kRefused;
    refused.receipt.why = answer.why;
    refused.receipt.task = answer.task;
    return switched(refused);
  }
  const SwitchOrder order = make_order(target, wait, now);
  present_ = Present{order, request, std::move(asked_by), now, wait, plan_.before, 1, false, std::move(switched)};
  world_.tell("switch", TaskId{}, RtpuId{}, under_way() + ": begun", now);
  announce(order);
}

bool SwitchCoordinator::cancel() {
  if (!present_ || !agreement().abort(present_->order.number)) return false;
  present_->is_cancelled = true;
  world_.announce();
  return true;
}

// An order that nobody wrote is due at once.
Nanoseconds SwitchCoordinator::orphan_due() const noexcept {
  const PlanWord plan = agreement().plan();
  if (present_ || !plan.is_open()) return kNever;
  const auto order = agreement().order(plan, world_.spec().sets.size(), world_.spec().tasks.size());
  return order ? order->until + kGrace : Nanoseconds{};
}

Nanoseconds SwitchCoordinator::next_due() const noexcept {
  return present_ ? present_->order.until + kGrace : orphan_due();
}

void SwitchCoordinator::look(Nanoseconds now) {
  if (orphan_due() <= now && agreement().abort(agreement().plan().number)) world_.announce();
  if (!present_) return;
  const SwitchOrder& order = present_->order;
  if (now >= order.until + kGrace && agreement().abort(order.number)) world_.announce();
  if (agreement().plan().is_open() || !is_over(order.number, order.members)) return;
  SwitchOutcome outcome = collect(*present_, now);
  const bool was_late = outcome.receipt.why == NoSwitch::kLate && now < order.until;
  if (was_late && !present_->is_cancelled && present_->tries < kMostTries && judge(order.target)) {
    ++present_->tries;
    present_->order = make_order(order.target, order.until - now, now);
    present_->order.lead = present_->order.lead * present_->tries;
    return announce(present_->order);
  }
  const Switched switched = std::move(present_->switched);
  present_.reset();
  tell(outcome, now);
  switched(outcome);
}

// A part says anything when its unit has died: what does not fit the application is left out.
SwitchOutcome SwitchCoordinator::collect(const Present& over, Nanoseconds now) {
  const ApplicationSpec& spec = world_.spec();
  const PlanWord word = agreement().plan();
  const bool is_committed = word.number == over.order.number && word.phase == SwitchPhase::kCommitted;
  SwitchOutcome outcome;
  outcome.asked_by = over.asked_by;
  SwitchReceipt& receipt = outcome.receipt;
  receipt.number = over.order.number;
  receipt.before = over.before;
  receipt.after = over.order.after;
  receipt.asked = over.asked;
  receipt.cause = over.request.cause;
  receipt.by = over.request.by;
  receipt.ended = now;
  receipt.end = is_committed ? SwitchEnd::kDone : SwitchEnd::kAborted;
  if (is_committed) receipt.at = agreement().at(word);
  for (std::uint32_t r = 0; r < world_.peers.n_rtpus(); ++r) {
    if (((over.order.members >> r) & 1u) == 0 || !world_.peers[RtpuId(r)].is_there()) continue;
    const SwitchPart& part = world_.peers[RtpuId(r)].block().switch_part();
    if (part.number != over.order.number) continue;
    receipt.armed = later(receipt.armed, part.armed);
    const bool says_more = receipt.why == NoSwitch::kNone || receipt.why == NoSwitch::kLate;
    if (part.why != NoSwitch::kNone && says_more && !is_committed) {
      receipt.why = part.why;
      if (part.task.index < spec.tasks.size()) receipt.task = part.task;
      if (part.variable.index < spec.variables.size()) receipt.variable = part.variable;
      receipt.value = part.value;
      receipt.said.assign({part.said, ::strnlen(part.said, SwitchPart::kSaid)});
    }
    for (std::uint32_t i = 0; i < std::min<std::size_t>(part.n_tasks, part.tasks.size()); ++i)
      if (is_in_range(part.tasks[i], spec, r)) outcome.tasks.push_back(part.tasks[i]);
    for (std::uint32_t i = 0; i < std::min(part.n_variables, SwitchPart::kVariablesKept); ++i)
      if (is_in_range(part.variables[i], spec, r)) outcome.variables.push_back(part.variables[i]);
  }
  if (over.is_cancelled && !is_committed) receipt.why = NoSwitch::kCancelled;
  if (!is_committed && receipt.why == NoSwitch::kNone) receipt.why = NoSwitch::kMemberDied;
  std::ranges::stable_sort(outcome.tasks, {}, &TaskPart::move);
  receipt.tasks = outcome.tasks;
  receipt.variables = outcome.variables;
  return outcome;
}

void SwitchCoordinator::tell(const SwitchOutcome& outcome, Nanoseconds now) {
  std::string text = control::receipt_text(outcome.receipt, world_.spec(), world_.keeper.origin);
  for (std::size_t begin = 0; begin < text.size();) {
    const std::size_t end = text.find('\n', begin);
    const std::string line = text.substr(begin, end - begin);
    world_.tell(line.starts_with("bump") ? "bump" : "switch", TaskId{}, RtpuId{}, line, now);
    begin = end + 1;
  }
}

}  // namespace chimera::manager
