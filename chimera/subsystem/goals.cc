// SPDX-License-Identifier: Apache-2.0
// Sends the spawns that goals ask for, in the order of constants, and gives up the goals that cannot be reached.
#include "chimera/subsystem/goals.h"

#include <algorithm>

namespace chimera::subsystem {

void Goals::recall(std::span<const std::uint32_t> remembered) {
  for (std::size_t t = 0; t < std::min(goals_.size(), remembered.size()); ++t) goals_[t].bits = remembered[t];
}

bool Goals::write(TaskId task, std::uint32_t goal) {
  Goal& mine = goals_[task.index];
  if ((goal & kGoalSpawn) != 0 && (mine.bits & kGoalSpawn) == 0) mine.failure = {};
  if (mine.bits == goal) return false;
  mine.bits = goal;
  state_.emit(RememberGoal{task, goal});
  return true;
}

bool Goals::any(std::uint32_t bits) const noexcept {
  return std::any_of(goals_.begin(), goals_.end(), [bits](const Goal& goal) { return (goal.bits & bits) != 0; });
}

std::vector<TaskId> Goals::with(std::uint32_t bits) const {
  std::vector<TaskId> tasks;
  for (TaskId task : state_.spec.on_order)
    if (has(task, bits)) tasks.push_back(task);
  return tasks;
}

void Goals::fail(TaskId task, const SignalRefusal& why) {
  goals_[task.index].failure = why;
  if (state_.observed.life_of(task) == RtpuLife::kUp) state_.observed.forget(task);
  const char* kind = why.kind == RefusalKind::kFault ? "fault" : "refused";
  state_.log(kind, task, state_.observed.rtpu(task), why.text());
  clear(task, kGoalSpawn | kGoalOn);
}

bool Goals::advance() {
  bool changed = false;
  for (TaskId task : state_.spec.init_order) changed = (is_pursued(task) && advance(task)) || changed;
  return changed;
}

bool Goals::advance(TaskId task) {
  if (state_.observed.life_of(task) != RtpuLife::kUp) {
    if (state_.now < state_.observed.since(state_.observed.rtpu(task)) + kStartLimit) return false;
    fail(task, state_.no_answer(task));
    return true;
  }
  if (!has(task, kGoalSpawn)) return false;
  if (state_.observed.is_created(task)) return clear(task, kGoalSpawn);
  if (state_.is_busy(task) || !has_constants(task)) return false;
  if (const TaskId rival = state_.find_rival(task); rival.is_valid()) return wait_for(task, rival);
  goals_[task.index].waits_since = kNever;
  goals_[task.index].command = state_.send(Signal::kSpawn, {&task, 1});
  return true;
}

// Waits for the kill of a rival. A rival that is a standby of the task has taken over and keeps the resource; any other
// rival may be killed soon.
bool Goals::wait_for(TaskId task, TaskId rival) {
  Nanoseconds& since = goals_[task.index].waits_since;
  if (state_.spec.stand_in(task, rival)) {
    state_.observed.forget(task);
    state_.log("note", task, state_.observed.rtpu(task),
               state_.name(task) + " stays NOT-CREATED: " + state_.name(rival) + " has its resource");
    return clear(task, kGoalSpawn | kGoalOn);
  }
  if (since == kNever) since = state_.now;
  if (state_.now < since + kStartLimit) return false;
  since = kNever;
  fail(task, state_.rivalry(task, rival));
  return true;
}

bool Goals::has_constants(TaskId task) const noexcept {
  for (const PortSpec& port : state_.spec.tasks[task.index].ports) {
    if (port.kind != CHIMERA_IN_CONST || !port.constant.is_valid()) continue;
    for (const PortOf& made : state_.spec.constants[port.constant.index].producers)
      if (made.task != task && !state_.observed.is_created(made.task) && has(made.task, kGoalSpawn)) return false;
  }
  return true;
}

// Notes the result of a spawn. If a process ended, RestartPolicy decides the goals of its tasks.
void Goals::on_result(const SignalResult& result) {
  const TaskId task = result.task;
  if (result.signal != Signal::kSpawn || goals_[task.index].command != result.command) return;
  if (result.refusal.kind == RefusalKind::kEnded) return;
  goals_[task.index].command = 0;
  if (!has(task, kGoalSpawn)) return;
  if (result.is_done()) clear(task, kGoalSpawn);
  else fail(task, state_.named(result));
}

Nanoseconds Goals::next_due() const noexcept {
  Nanoseconds next = kNever;
  for (std::size_t t = 0; t < goals_.size(); ++t) {
    const TaskId task(t);
    if (goals_[t].waits_since != kNever && has(task, kGoalSpawn))
      next = std::min(next, goals_[t].waits_since + kStartLimit);
    if (!is_pursued(task) || state_.observed.life_of(task) == RtpuLife::kUp) continue;
    next = std::min(next, state_.observed.since(state_.observed.rtpu(task)) + kStartLimit);
  }
  return next;
}

}  // namespace chimera::subsystem
