// SPDX-License-Identifier: Apache-2.0
// Makes the tasks of a context from their specs and wires them.
#include "chimera/runtime/life/task_set.h"

#include "chimera/base/message.h"
#include "chimera/runtime/life/stale_inputs.h"
#include "chimera/runtime/plan/switch_plan.h"

namespace chimera {
namespace {

Result<void> check_producers(const ApplicationSpec& spec) {
  if constexpr (mechanisms::kVerified) return {};  // the tables of an image are verified
  for (const Variable& variable : spec.variables) {
    if (!variable.producers.empty() || variable.is_given()) continue;
    const std::string_view reader = spec.tasks[variable.consumers[0].task.index].name;
    return (Message("no task produces state variable ") << variable.name).error(ErrorCode::kBadInput, reader);
  }
  return {};
}

}  // namespace

TaskSet::~TaskSet() {
  for (Task& task : tasks_) {
    TaskMemory& memory = memories_[task.id.index];
    if (!memory.is_planned()) continue;
    if constexpr (mechanisms::kBackground) (void)methods_.end_background(task, {});
    memory.destroy(task);
  }
}

Result<void> TaskSet::build(std::span<const chimera_component* const> components) {
  const std::size_t n = spec_.tasks.size();
  CHIMERA_ASSERT(components.size() == n && tasks_.empty());
  memories_ = memory_.take<TaskMemory>(n);
  if (auto planned = plan_memories(components); !planned) return planned;
  tasks_ = memory_.take<Task>(n);
  hosts_ = memory_.take<TaskHost>(n);
  on_ = memory_.take<bool>(n);
  states_ = memory_.take<State>(n);
  listed_ = memory_.take<TaskStatus>(mechanisms::kPeers ? n : 0);
  for (std::size_t t = 0; t < n; ++t) prepare_task(t, components[t]);
  if (auto produced = check_producers(spec_); !produced) return produced;
  if (auto laid = table_.prepare(spec_, place_, memory_); !laid) return laid;
  for (const Task& task : tasks_)
    if (is_mine(task.id)) table_.place_outputs(task.id, memories_[task.id.index], memory_);
  prepare_parts();
  return {};
}

Result<void> TaskSet::plan_memories(std::span<const chimera_component* const> components) {
  for (std::size_t t = 0; t < spec_.tasks.size(); ++t) {
    if (mechanisms::kPeers && place_.rtpu.is_valid() && spec_.tasks[t].rtpu != place_.rtpu) continue;
    const auto planned = TaskMemory::create(spec_.tasks[t], *components[t], memory_);
    if (!planned) return planned.error();
    memories_[t] = *planned;
  }
  return {};
}

void TaskSet::prepare_task(std::size_t t, const chimera_component* component) {
  Task& task = tasks_[t];
  task.spec = &spec_.tasks[t];
  task.id = TaskId(t);
  task.component = component;
  hosts_[t] = {this, &task, nullptr, nullptr};
  task.call.fault = &task.said;
  task.call.host = &TaskHost::kCalls;
  task.call.context = &hosts_[t];
  task.inputs = memories_[t].inputs();
  task.running = place_.running;
}

void TaskSet::prepare_parts() {
  methods_.prepare(memories_, {place_.at_edge, place_.making}, place_.safe_frames);
  slow_.prepare(tasks_, hosts_, methods_, place_.service, *place_.serving, memory_);
  sent_.prepare(tasks_, memories_, others());
  flag_.prepare(spec_.variables, tasks_, memory_);
  life_.prepare(spec_, memory_);
  standbys_.prepare(spec_, life_.judge().rivals(), memory_);
  if (others() != nullptr) changes_.prepare(tasks_.size(), memory_);
  constants_.prepare(spec_, table_, memories_, others(), memory_);
  for (std::size_t t = 0; mechanisms::kStale && t < tasks_.size(); ++t) {
    if (!memories_[t].is_planned()) continue;
    Nanoseconds after = kNever;
    for (const StaleSpec& stale : spec_.stale)
      if (stale.task.index == t) after = stale.after;
    hosts_[t].stale = StaleInputs::make(after, TaskId(t), memories_[t], spec_, memory_);
  }
  sources_.prepare(spec_, table_, tasks_, memories_, others(), place_.preemptive, memory_);
}

void TaskSet::judge_as(const TaskBits* target) noexcept {
  target_ = target;
  if (target != nullptr) standbys_.follow_switch(*target);
  on_set_changed();
}

bool TaskSet::counts_as_on(TaskId task) const noexcept {
  if (standbys_.is_covered(task)) return true;
  const State state = states_[task.index];
  if (target_ == nullptr) return state == State::kOn;
  return target_->has(task) && (state == State::kOn || state == State::kOff);
}

void TaskSet::on_set_changed() noexcept {
  for (const Task& task : tasks_)
    states_[task.id.index] = is_mine(task.id) ? task.shown_state() : others()->state(task.id);
  if (standbys_.n_groups() > 0) {
    JobClock* const clock = methods_.clock();
    standbys_.follow(states_, life_.judge().living(), clock == nullptr ? Nanoseconds{} : clock->now());
    if (standbys_.is_any_waiting() || standbys_.has_hot()) sent_.want_edge();
  }
  for (const Task& task : tasks_) on_[task.id.index] = counts_as_on(task.id);
  const std::uint32_t in_force = set_in_force(spec_, [this](TaskId task) -> bool { return on_[task.index]; });
  flag_.follow(on_, standbys_.is_any_uncovered(), in_force);
  for (Task& task : tasks_) {
    if (!is_mine(task.id)) continue;
    if (task.standing == Standing::kWarm && !task.is_warm()) task.standing = Standing::kPlain;
    if constexpr (!mechanisms::kPeers) continue;  // no other process reads the changes
    const TaskStatus now{task.shown_state(), task.in_service(), memories_[task.id.index].incarnation()};
    TaskStatus& listed = listed_[task.id.index];
    if (now != listed) changes_.add_status(task.id, listed, now);
    listed = now;
  }
  changes_.add_flag();
}

}  // namespace chimera
