// SPDX-License-Identifier: Apache-2.0
// Orders switches of several real-time units in virtual time, and puts their parts together.
#include "chimera/runtime/virtual/virtual_switches.h"

#include <algorithm>
#include <utility>

#include "chimera/base/assert.h"

namespace chimera {
namespace {

// As the manager has them.
constexpr Nanoseconds kPatience = seconds(10);

class GapsOfUnits final : public NeededGaps {
 public:
  explicit GapsOfUnits(VirtualPeers& peers) noexcept : peers_(peers) {}
  Nanoseconds for_on(TaskId task) const noexcept override {
    const TaskSpec& spec = peers_.spec().tasks[task.index];
    const TaskSet* const there = peers_.tasks(spec.rtpu);
    return there == nullptr ? Nanoseconds{}
                            : IdleGap::needed(spec, there->tasks()[task.index].profile, Method::kOn);
  }

 private:
  VirtualPeers& peers_;
};

Nanoseconds later(Nanoseconds a, Nanoseconds b) noexcept { return a == kNever ? b : b == kNever ? a : std::max(a, b); }

}  // namespace

VirtualSwitches::VirtualSwitches(VirtualPeers& peers, std::size_t n, AskedTasks* asked)
    : peers_(peers), asked_(asked) {
  const ApplicationSpec& spec = peers.spec();
  for (std::uint32_t r = 0; r < spec.rtpus.size(); ++r) members_.emplace_back(*this, r);
  if (n == 0) return;
  CHIMERA_ASSERT(spec.tasks.size() <= kMaxSwitchedTasks && spec.rtpus.size() <= kMaxContexts);
  planner_.prepare(spec, memory_);
  ways_.prepare(spec, memory_);
  constants_ = set_of_start(spec);
  receipts_.prepare(spec, n, memory_);
  standing_ = memory_.take<TaskStanding>(spec.tasks.size());
}

std::uint16_t VirtualSwitches::living() const noexcept {
  std::uint32_t living = 0;
  for (std::uint32_t r = 0; r < members_.size(); ++r)
    if (peers_.tasks(RtpuId(r)) != nullptr && peers_.died(RtpuId(r)) == kNever) living |= 1u << r;
  return static_cast<std::uint16_t>(living);
}

bool VirtualSwitches::leads_to(const SwitchRequest& request) const noexcept {
  if (!is_under_way()) return false;
  return request.lists.are_there() ? request.lists.are_met_by(target_) : present_->after == request.set;
}

void VirtualSwitches::ring() noexcept {
  for (std::uint32_t r = 0; r < members_.size(); ++r) peers_.ring(RtpuId(r));
}

// From the proposal to the change: the longest job so far may be under way somewhere.
Nanoseconds VirtualSwitches::lead() const noexcept {
  Nanoseconds longest;
  for (std::uint32_t r = 0; r < members_.size(); ++r) {
    const TaskSet* const tasks = peers_.tasks(RtpuId(r));
    if (tasks == nullptr) continue;
    for (const Task& task : tasks->tasks())
      if (tasks->is_mine(task.id) && task.state == State::kOn)
        longest = std::max(longest, task.profile.execution[static_cast<int>(Method::kCycle)].max);
  }
  return lead_of(plan_, peers_.spec().tasks, longest);
}

void VirtualSwitches::ask(SwitchRequest request, Nanoseconds now) noexcept {
  finish(now);
  for (std::size_t t = 0; t < standing_.size(); ++t) standing_[t] = standing_of(TaskId(t));
  TaskBits target;
  if (!find_target(request, peers_.spec(), standing_, asked_, now, target)) return;
  PlanAnswer answer{NoSwitch::kUnderWay, {}};
  if (!is_under_way()) answer = planner_.plan(target, standing_, plan_);
  const SwitchWay way = answer ? judge_way() : SwitchWay();
  const bool is_nothing = answer.why == NoSwitch::kNothingToDo;
  if (is_nothing && request.cause != SwitchCause::kScript) return;
  const std::uint32_t number = is_nothing ? 0 : receipts_.next_number();
  if (is_under_way() && !receipts_.has_room()) return receipts_.leave_out();  // the last place is that of the present
  SwitchReceipt& receipt = receipts_.add();
  note_request(receipt, request, planner_.set_in_force(standing_), way, now);
  receipt.number = number;
  if (!answer) return refuse(receipt, answer);
  present_ = &receipt;
  target_ = target;
  order(now + kPatience);
}

SwitchWay VirtualSwitches::judge_way() noexcept {
  for (std::uint32_t r = 0; r < members_.size(); ++r) {
    if (((living() >> r) & 1u) == 0) continue;
    ContextConstants& constants = peers_.tasks(RtpuId(r))->constants();
    constants.read_foreign();
    return ways_.judge(plan_, standing_, constants_, constants, GapsOfUnits(peers_));
  }
  return {};
}

// The next try of the present one.
void VirtualSwitches::order(Nanoseconds until) noexcept {
  until_ = until;
  SwitchOrder order;
  for (std::size_t t = 0; t < standing_.size(); ++t)
    if (standing_[t].state == State::kOn) order.on.add(TaskId(t));
  n_tasks_ = n_variables_ = 0;
  order.number = next_plan(agreement().plan().number);
  order.members = living();
  order.after = present_->after;
  order.target = target_;
  order.slow = present_->way.slow;
  order.constants = constants_;
  order.until = until;
  order.lead = lead_of_try(lead(), present_->tries);
  agreement().announce(order);
  ring();
}

TaskStanding VirtualSwitches::standing_of(TaskId task) const noexcept {
  return {peers_.state(task), !peers_.presence(task).lives};
}

// What found no gap for `on`, or a device that is not ready, is done under the flag; what was only late has more time.
bool VirtualSwitches::try_again(Nanoseconds now) noexcept {
  const std::uint8_t slow = present_->way.slow == 0 ? reason_to_go_slowly(present_->why) : 0;
  const bool was_late = present_->why == NoSwitch::kLate && now < until_;
  if ((slow == 0 && !was_late) || present_->tries >= kMostTries) return false;
  for (std::size_t t = 0; t < standing_.size(); ++t) standing_[t] = standing_of(TaskId(t));
  if (!planner_.plan(target_, standing_, plan_)) return false;
  present_->why = NoSwitch::kNone;
  present_->task = {};
  if (slow != 0) present_->way.slow = slow;
  ++present_->tries;
  order(slow != 0 ? now + kPatience : until_);
  return true;
}

void VirtualSwitches::Member::tell_adopted(std::uint16_t number) noexcept {
  progress_.adopted = number;
  all_.peers_.show_change(RtpuId(me_));
}

void VirtualSwitches::Member::tell_over(const SwitchReceipt& receipt) noexcept {
  all_.add_part(receipt, RtpuId(me_));
  const PlanWord plan = all_.agreement().plan();
  progress_.adopted = plan.number;
  progress_.over = plan.number;
  all_.ring();
}

void VirtualSwitches::add_part(const SwitchReceipt& part, RtpuId rtpu) noexcept {
  if (!is_under_way()) return;
  const auto is_its = [&](TaskId task) { return peers_.spec().tasks[task.index].rtpu == rtpu; };
  for (const TaskPart& task : part.tasks)
    if (is_its(task.task)) present_->tasks[n_tasks_++] = task;
  for (const VariablePart& variable : part.variables)
    if (is_its(variable.handover.to.task)) present_->variables[n_variables_++] = variable;
  for (const TaskId task : part.reinitialised)
    if (is_its(task)) append(present_->reinitialised, task);
  present_->flag = std::max(present_->flag, part.flag);
  if (!present_->not_back.is_valid()) present_->not_back = part.not_back;
  present_->armed = later(present_->armed, part.armed);
  if (part.end == SwitchEnd::kDone) present_->at = part.at;
  if (part.why == NoSwitch::kNone || !(present_->why == NoSwitch::kNone || is_of_another(present_->why))) return;
  present_->why = part.why;
  present_->task = part.task;
  present_->variable = part.variable;
  present_->value = part.value;
  present_->said = part.said;
}

void VirtualSwitches::look(Nanoseconds now) noexcept {
  finish(now);
  if (wish_ && leads_to(wish_)) wish_ = {};
  if (wish_ && !is_under_way()) ask(std::exchange(wish_, {}), now);
}

void VirtualSwitches::finish(Nanoseconds now) noexcept {
  const PlanWord plan = agreement().plan();
  if (!is_under_way() || plan.is_open()) return;
  for (std::uint32_t r = 0; r < members_.size(); ++r)
    if (((living() >> r) & 1u) != 0 && !members_[r].is_over(plan.number)) return;
  const bool is_committed = plan.phase == SwitchPhase::kCommitted;
  if (is_committed && present_->after != kNoSet) constants_ = present_->after;
  if (!is_committed && try_again(now)) return;
  present_->end = is_committed ? SwitchEnd::kDone : SwitchEnd::kAborted;
  if (is_committed) present_->at = agreement().at(plan);
  if (is_committed) present_->why = NoSwitch::kNone;
  else if (present_->why == NoSwitch::kNone) present_->why = NoSwitch::kMemberDied;
  present_->ended = now;
  present_->tasks = present_->tasks.first(n_tasks_);
  present_->variables = present_->variables.first(n_variables_);
  const auto is_before = [](const TaskPart& a, const TaskPart& b) { return a.move < b.move; };
  const auto begin = present_->tasks.begin();
  for (auto part = begin; part != present_->tasks.end(); ++part)  // std::stable_sort allocates
    std::rotate(std::upper_bound(begin, part, *part, is_before), part, part + 1);
  sort_reinitialised();
  present_ = nullptr;
}

// As they were: in the order of initialisation over all units.
void VirtualSwitches::sort_reinitialised() noexcept {
  const std::span<TaskId> list = present_->reinitialised;
  std::size_t n = 0;
  for (const TaskId next : peers_.spec().init_order)
    for (std::size_t i = n; i < list.size(); ++i)
      if (list[i] == next) std::swap(list[n++], list[i]);
}

}  // namespace chimera
