// SPDX-License-Identifier: Apache-2.0
// Makes the orders of a switch and one receipt of the parts that the contexts say.
#include "chimera/runtime/switch/switch_orders.h"

#include <algorithm>

namespace chimera {
namespace {

Nanoseconds later(Nanoseconds a, Nanoseconds b) noexcept { return a == kNever ? b : b == kNever ? a : std::max(a, b); }

// A wrong part may name a task twice: what has no room is left out.
template <class T>
void append_within(std::span<T>& list, const T& item, std::size_t room) noexcept {
  if (list.size() == room) return;
  list = {list.data(), list.size() + 1};
  list.back() = item;
}

// Tasks by what happens to them, tasks that were re-initialised in the order of initialisation.
void sort(SwitchReceipt& receipt, std::span<const TaskId> init_order) noexcept {
  const auto is_before = [](const TaskPart& a, const TaskPart& b) { return a.move < b.move; };
  const auto begin = receipt.tasks.begin();
  for (auto part = begin; part != receipt.tasks.end(); ++part)  // std::stable_sort allocates
    std::rotate(std::upper_bound(begin, part, *part, is_before), part, part + 1);
  const std::span<TaskId> list = receipt.reinitialised;
  std::size_t n = 0;
  for (const TaskId next : init_order)
    for (std::size_t i = n; i < list.size(); ++i)
      if (list[i] == next) std::swap(list[n++], list[i]);
}

}  // namespace

void SwitchOrders::prepare(const ApplicationSpec& spec, bool is_alone, SetupMemory& memory) {
  spec_ = &spec;
  is_alone_ = is_alone;
  planner_.prepare(spec, memory);
  ways_.prepare(spec, memory);
  statuses_ = memory.take<TaskStatus>(spec.tasks.size());
}

void SwitchOrders::look() noexcept {
  for (std::size_t t = 0; t < statuses_.size(); ++t) statuses_[t] = members_.status(TaskId(t));
}

PlanAnswer SwitchOrders::judge(TaskBits& target, SwitchCause cause) noexcept {
  look();
  way_ = {};
  if (cause != SwitchCause::kScript) {
    if (const TaskId kept = heed_persons(target); kept.is_valid()) return {NoSwitch::kKeptOff, kept};
  }
  const PlanAnswer answer = planner_.plan(target, statuses_, plan_);
  way_ = answer ? ways_.judge(plan_, statuses_, constants_in_force(), members_.constants(), *this) : SwitchWay();
  return answer;
}

// The first task of the target that is kept OFF. Where the tasks that are ON are no set of the description, and one of
// them stands in for a task of the target, it took over and stays.
TaskId SwitchOrders::heed_persons(TaskBits& target) const noexcept {
  const bool may_have_taken_over = set_of(*spec_, on()) == kNoSet;
  for (const TaskId id : spec_->on_order) {
    if (!target.has(id) || is_on(id)) continue;
    if (members_.is_kept_off(id)) return id;
    for (const TaskId by : spec_->on_order) {
      if (!may_have_taken_over || !is_on(by) || target.has(by) || !spec_->stand_in(id, by)) continue;
      target.remove(id);
      target.add(by);
      break;
    }
  }
  return {};
}

Nanoseconds SwitchOrders::for_on(TaskId task) const noexcept {
  if (!members_.needs_gaps(task)) return {};
  return IdleGap::needed(spec_->tasks[task.index], members_.profile(task), Method::kOn);
}

std::uint32_t SwitchOrders::constants_in_force() const noexcept {
  const PlanWord plan = agreement().plan();
  const auto order = agreement().order(plan, spec_->sets.size(), spec_->tasks.size());
  if (!order) return set_of_start(*spec_);
  return plan.phase == SwitchPhase::kCommitted ? order->constants_after() : order->constants;
}

// The longest job so far may be under way in some context.
Nanoseconds SwitchOrders::lead() const noexcept {
  if (is_alone_) return {};
  Nanoseconds longest;
  for (std::size_t t = 0; t < statuses_.size(); ++t)
    if (is_on(TaskId(t)))
      longest = std::max<Nanoseconds>(longest, members_.profile(TaskId(t)).execution[CHIMERA_CYCLE].max);
  return lead_of(plan_, spec_->tasks, longest);
}

void SwitchOrders::make(OrderedSwitch& next, const TaskBits& target, Nanoseconds until) const noexcept {
  next.before = set_in_force();
  next.way = way_;
  make_order(next, target, until);
}

void SwitchOrders::make_order(OrderedSwitch& next, const TaskBits& target, Nanoseconds until) const noexcept {
  SwitchOrder order;
  order.number = next_plan(agreement().plan().number);
  order.members = members_.living();
  order.after = plan_.after;
  order.target = target;
  order.slow = next.way.slow;
  order.constants = constants_in_force();
  order.until = until;
  order.lead = lead_of_try(lead(), next.tries);
  order.on = on();
  next.order = order;
}

void SwitchOrders::announce(const OrderedSwitch& next) noexcept {
  agreement().announce(next.order);
  members_.ring();
}

bool SwitchOrders::abort(const OrderedSwitch& present) noexcept {
  if (!agreement().abort(present.order.number)) return false;
  members_.ring();
  return true;
}

bool SwitchOrders::find_plan_of(const SwitchOrder& order) noexcept {
  for (std::size_t t = 0; t < statuses_.size(); ++t)
    statuses_[t] = {order.on.has(TaskId(t)) ? State::kOn : State::kOff, false};
  return static_cast<bool>(planner_.plan(order.target, statuses_, plan_));
}

bool SwitchOrders::are_over(std::uint16_t plan, std::uint16_t contexts) const noexcept {
  for (std::uint32_t c = 0; c < kMaxContexts; ++c)
    if ((contexts >> c & 1u) != 0 && members_.is_busy_with(c, plan)) return false;
  return true;
}

void SwitchOrders::collect(const OrderedSwitch& over, NoSwitch otherwise, Nanoseconds now,
                           SwitchReceipt& receipt) const noexcept {
  const PlanWord word = agreement().plan();
  Nanoseconds at = kNever;
  if (otherwise == NoSwitch::kDamaged) at = on() == over.order.target ? told_change(over, now) : kNever;
  else if (word.number == over.order.number && word.phase == SwitchPhase::kCommitted) at = agreement().at(word);
  const bool is_committed = at != kNever;
  SwitchReceipt empty;
  empty.tasks = receipt.tasks.first(0);
  empty.variables = receipt.variables.first(0);
  empty.reinitialised = receipt.reinitialised.first(0);
  receipt = empty;
  receipt.number = over.number;
  receipt.before = over.before;
  receipt.on_before = over.order.on;
  receipt.after = over.order.after;
  receipt.cause = over.cause;
  receipt.by = over.by;
  receipt.asked = over.asked;
  receipt.way = over.way;
  receipt.tries = over.tries;
  receipt.end = is_committed ? SwitchEnd::kDone : SwitchEnd::kAborted;
  receipt.at = at;
  for (std::uint32_t c = 0; c < kMaxContexts; ++c) {
    SwitchReceipt part;
    const bool is_member = (over.order.members >> c & 1u) != 0;
    if (is_member && members_.read_part(c, over.order.number, part)) add_part(part, c, now, receipt);
  }
  if (receipt.ended == kNever) receipt.ended = now;
  if (!is_committed && receipt.why == NoSwitch::kNone) receipt.why = otherwise;
  sort(receipt, spec_->init_order);
}

// The instant of the change in the part of a context; `otherwise`, which is later, if no part has it.
Nanoseconds SwitchOrders::told_change(const OrderedSwitch& over, Nanoseconds otherwise) const noexcept {
  for (std::uint32_t c = 0; c < kMaxContexts; ++c) {
    SwitchReceipt part;
    if ((over.order.members >> c & 1u) == 0 || !members_.read_part(c, over.order.number, part)) continue;
    if (part.end == SwitchEnd::kDone && part.at >= over.asked && part.at <= otherwise) return part.at;
  }
  return otherwise;
}

bool SwitchOrders::is_of(TaskId task, std::uint32_t context) const noexcept {
  return task.index < spec_->tasks.size() && (is_alone_ || spec_->tasks[task.index].rtpu.index == context);
}

// A context that has died may have left any value: values that do not fit the application are left out.
void SwitchOrders::add_part(const SwitchReceipt& part, std::uint32_t context, Nanoseconds now,
                            SwitchReceipt& to) const noexcept {
  const auto is_possible = [&](Nanoseconds at) { return at >= to.asked && at <= now; };
  if (is_possible(part.armed)) to.armed = later(to.armed, part.armed);
  if (is_possible(part.ended)) to.ended = later(to.ended, part.ended);
  if (part.flag > Nanoseconds{} && part.flag <= now - to.asked) to.flag = std::max(to.flag, part.flag);
  if (is_of(part.not_back, context)) to.not_back = part.not_back;
  add_lists(part, context, to);
  const bool says_more = to.why == NoSwitch::kNone || is_of_another(to.why);
  if (part.why == NoSwitch::kNone || !says_more || to.end != SwitchEnd::kAborted) return;
  to.why = part.why;
  if (part.task.index < spec_->tasks.size()) to.task = part.task;
  if (part.variable.index < spec_->variables.size()) to.variable = part.variable;
  to.value = part.value;
  to.said = part.said;
}

void SwitchOrders::add_lists(const SwitchReceipt& part, std::uint32_t context, SwitchReceipt& to) const noexcept {
  const std::size_t n_tasks = spec_->tasks.size();
  for (const TaskPart& each : part.tasks)
    if (is_of(each.task, context) && each.move <= TaskMove::kStays) append_within(to.tasks, each, n_tasks);
  for (const VariablePart& each : part.variables) {
    const Handover& h = each.handover;
    const bool is_known = h.variable.index < spec_->variables.size() &&
                          (!h.from.task.is_valid() || h.from.task.index < n_tasks);
    if (is_known && is_of(h.to.task, context)) append_within(to.variables, each, spec_->variables.size());
  }
  for (const TaskId each : part.reinitialised)
    if (is_of(each, context)) append_within(to.reinitialised, each, n_tasks);
}

bool SwitchOrders::make_next_try(OrderedSwitch& over, NoSwitch why, Nanoseconds now) noexcept {
  const std::uint8_t slow = over.order.slow == 0 ? reason_to_go_slowly(why) : 0;
  const bool was_late = why == NoSwitch::kLate && now < over.order.until;
  if ((slow == 0 && !was_late) || over.tries >= kMostTries) return false;
  look();
  const TaskBits target = over.order.target;
  if (!planner_.plan(target, statuses_, plan_)) return false;
  const Nanoseconds until = slow != 0 ? now + (over.order.until - over.asked) : over.order.until;
  if (slow != 0) over.way.slow = slow;
  ++over.tries;
  make_order(over, target, until);
  return true;
}

}  // namespace chimera
