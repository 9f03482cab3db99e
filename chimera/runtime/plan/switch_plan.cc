// SPDX-License-Identifier: Apache-2.0
// Makes the plan of a switch from the tasks that are ON and the configuration that is wanted.
#include "chimera/runtime/plan/switch_plan.h"

#include <algorithm>

namespace chimera {
namespace {

bool is_on(const TaskStatus& status) noexcept { return status.state == State::kOn; }

}  // namespace

TaskBits tasks_on(std::span<const TaskStatus> statuses) noexcept {
  TaskBits on;
  for (std::size_t t = 0; t < statuses.size(); ++t)
    if (is_on(statuses[t])) on.add(TaskId(t));
  return on;
}

TaskBits tasks_of(const ApplicationSpec& spec, std::uint32_t set) noexcept {
  TaskBits bits;
  for (const TaskId id : spec.sets[set].order) bits.add(id);
  return bits;
}

TaskBits target_of(const SwitchPlan& plan) noexcept {
  TaskBits bits;
  for (const auto ids : {plan.arriving, plan.staying})
    for (const TaskId id : ids) bits.add(id);
  return bits;
}

std::uint32_t set_of(const ApplicationSpec& spec, const TaskBits& tasks) noexcept {
  for (std::uint32_t s = 0; s < spec.sets.size(); ++s)
    if (tasks_of(spec, s) == tasks) return s;
  return kNoSet;
}

const SafeCondition& asked_of(const ApplicationSpec& spec, std::uint32_t set) noexcept {
  static constexpr SafeCondition kNothing;
  return set == kNoSet ? kNothing : spec.sets[set].safe_when;
}

SwitchRun find_run(const SwitchPlan& plan, std::span<const TaskSpec> tasks, std::uint16_t number) noexcept {
  const auto rtpu = [&](std::size_t i) { return tasks[plan.arriving[i].index].rtpu; };
  SwitchRun run;
  for (std::uint32_t n = 0; run.end < plan.arriving.size(); ++n) {
    run.begin = run.end++;
    while (run.end < plan.arriving.size() && rtpu(run.end) == rtpu(run.begin)) ++run.end;
    if (n == number) return run;
  }
  return {plan.arriving.size(), plan.arriving.size()};
}

Nanoseconds lead_of(const SwitchPlan& plan, std::span<const TaskSpec> tasks, Nanoseconds longest_job) noexcept {
  constexpr Nanoseconds kEnough = milliseconds(1), kBeyondLongestJob = microseconds(200);
  Nanoseconds lead = kEnough;
  for (const auto ids : {plan.arriving, plan.leaving})
    for (const TaskId id : ids)
      if (!tasks[id.index].aperiodic) lead = std::min(lead, Nanoseconds{tasks[id.index].period.count * 3 / 4});
  return std::max(lead, longest_job + kBeyondLongestJob);
}

void SwitchPlanner::prepare(const ApplicationSpec& spec, SetupMemory& memory) {
  spec_ = &spec;
  rivals_.prepare(spec, memory);
  in_target_ = memory.take<bool>(spec.tasks.size());
  arriving_ = memory.take<TaskId>(spec.tasks.size());
  leaving_ = memory.take<TaskId>(spec.tasks.size());
  staying_ = memory.take<TaskId>(spec.tasks.size());
  target_ = memory.take<TaskId>(spec.tasks.size());
  handovers_ = memory.take<Handover>(spec.variables.size());
}

PlanAnswer SwitchPlanner::plan(std::uint32_t target, std::span<const TaskStatus> statuses,
                               SwitchPlan& plan) noexcept {
  if (target >= spec_->sets.size()) return {NoSwitch::kUnknownSet, {}};
  if (const SwitchPlan* const made = made_plan(target, statuses)) {
    const std::uint32_t number = plan.number;
    plan = *made;
    plan.number = number;
    return {};
  }
  const PlanAnswer answer = plan_for(spec_->sets[target].order, statuses, plan);
  if (answer) plan.after = target;
  return answer;
}

PlanAnswer SwitchPlanner::plan(const TaskBits& target, std::span<const TaskStatus> statuses,
                               SwitchPlan& plan) noexcept {
  if (const std::uint32_t set = set_of(*spec_, target); set != kNoSet) return this->plan(set, statuses, plan);
  std::size_t n = 0;
  for (const TaskId id : spec_->on_order)
    if (target.has(id)) target_[n++] = id;
  const PlanAnswer answer = plan_for(target_.first(n), statuses, plan);
  if (answer) plan.after = kNoSet;
  return answer;
}

// The plan that was made before the run. Null: there is none, or some task is in another state than the plan assumes.
const SwitchPlan* SwitchPlanner::made_plan(std::uint32_t target,
                                           std::span<const TaskStatus> statuses) const noexcept {
  if (spec_->plans == nullptr) return nullptr;
  const std::uint32_t before = set_of(*spec_, tasks_on(statuses));
  if (before == kNoSet || before == target) return nullptr;
  const SwitchPlan& made = spec_->plans[before * spec_->sets.size() + target];
  const auto is_ready = [&](TaskId id) {
    const TaskStatus& now = statuses[id.index];
    return !now.in_service && (now.state == State::kOff || now.state == State::kOn);
  };
  const bool are_ready = std::all_of(made.arriving.begin(), made.arriving.end(), is_ready) &&
                         std::all_of(made.staying.begin(), made.staying.end(), is_ready);
  return are_ready && made.after == target ? &made : nullptr;
}

PlanAnswer SwitchPlanner::plan_for(std::span<const TaskId> order, std::span<const TaskStatus> statuses,
                                   SwitchPlan& plan) noexcept {
  std::size_t arriving = 0, leaving = 0, staying = 0;
  std::fill(in_target_.begin(), in_target_.end(), false);
  for (const TaskId id : order) {
    const TaskStatus& now = statuses[id.index];
    if (now.state == State::kError) return {NoSwitch::kInError, id};
    const bool is_absent = now.state == State::kNotCreated && !rivals_.may_be_absent(id);
    if (is_absent || now.in_service) return {NoSwitch::kNotCreated, id};
    in_target_[id.index] = true;
    if (is_on(now)) staying_[staying++] = id;
    else arriving_[arriving++] = id;
  }
  for (std::size_t i = spec_->on_order.size(); i-- > 0;) {
    const TaskId id = spec_->on_order[i];
    if (is_on(statuses[id.index]) && !is_in_target(id)) leaving_[leaving++] = id;
  }
  if (arriving == 0 && leaving == 0) return {NoSwitch::kNothingToDo, {}};
  plan.deadline = nullptr;
  plan.before = set_in_force(statuses);
  plan.arriving = arriving_.first(arriving);
  plan.leaving = leaving_.first(leaving);
  plan.staying = staying_.first(staying);
  plan.handovers = list_handovers(statuses);
  return {};
}

std::span<const Handover> SwitchPlanner::list_handovers(std::span<const TaskStatus> statuses) noexcept {
  std::size_t n = 0;
  for (std::size_t v = 0; v < spec_->variables.size(); ++v) {
    PortOf from, to;
    for (const PortOf& producer : spec_->variables[v].producers) {
      if (is_on(statuses[producer.task.index])) from = producer;
      if (is_in_target(producer.task)) to = producer;
    }
    if (to.task.is_valid() && !(from == to)) handovers_[n++] = {VariableId(v), from, to};
  }
  return handovers_.first(n);
}

}  // namespace chimera
