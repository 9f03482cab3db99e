// SPDX-License-Identifier: Apache-2.0
#include "chimera/subsystem/goals.h"

#include <algorithm>

namespace chimera::subsystem {

void Goals::recall(std::span<const std::uint32_t> remembered) {
  for (std::size_t t = 0; t < std::min(goals_.size(), remembered.size()); ++t) goals_[t].bits = remembered[t];
}

void Goals::set(TaskId task, std::uint32_t goal) {
  Goal& mine = goals_[task.index];
  if ((goal & kGoalSpawn) != 0 && (mine.bits & kGoalSpawn) == 0) mine.failure.clear();
  if (mine.bits == goal) return;
  mine.bits = goal;
  at_.act(RememberGoal{task, goal});
}

bool Goals::any(std::uint32_t bits) const noexcept {
  return std::any_of(goals_.begin(), goals_.end(), [bits](const Goal& goal) { return (goal.bits & bits) != 0; });
}

std::vector<TaskId> Goals::with(std::uint32_t bits) const {
  std::vector<TaskId> tasks;
  for (TaskId task : at_.order)
    if (has(task, bits)) tasks.push_back(task);
  return tasks;
}

void Goals::fail(TaskId task, const char* kind, std::string why) {
  goals_[task.index].failure = why;
  if (at_.roster.life_of(task) == Life::kUp) at_.roster.forget(task);
  at_.tell(kind, task, at_.roster.rtpu(task), std::move(why));
  clear(task, kGoalSpawn | kGoalOn);
}

void Goals::pursue() {
  for (TaskId task : at_.spec.init_order)
    if (is_pursued(task)) pursue(task);
}

void Goals::pursue(TaskId task) {
  const Life life = at_.roster.life_of(task);
  if (life != Life::kUp) {
    if (at_.now >= at_.roster.since(at_.roster.rtpu(task)) + kStartLimit) fail(task, "refused", at_.no_answer(task));
    return;
  }
  if (!has(task, kGoalSpawn)) return;
  if (at_.roster.is_created(task)) return clear(task, kGoalSpawn);
  if (at_.is_busy(task) || !has_constants(task)) return;
  goals_[task.index].command = at_.send(Signal::kSpawn, {&task, 1});
}

bool Goals::has_constants(TaskId task) const noexcept {
  const auto& makers = at_.makers[task.index];
  return std::all_of(makers.begin(), makers.end(),
                     [this](TaskId maker) { return at_.roster.is_created(maker) || !has(maker, kGoalSpawn); });
}

void Goals::take(const Reply& reply) {
  if (reply.signal != Signal::kSpawn || goals_[reply.task.index].command != reply.command || reply.is_death) return;
  goals_[reply.task.index].command = 0;
  if (!has(reply.task, kGoalSpawn)) return;
  if (reply.is_done) clear(reply.task, kGoalSpawn);
  else fail(reply.task, reply.is_fault ? "fault" : "refused", at_.sentence(reply));
}

Nanoseconds Goals::next_due() const noexcept {
  Nanoseconds next = kNever;
  for (std::size_t t = 0; t < goals_.size(); ++t) {
    const TaskId task(t);
    if (!is_pursued(task) || at_.roster.life_of(task) == Life::kUp) continue;
    next = std::min(next, at_.roster.since(at_.roster.rtpu(task)) + kStartLimit);
  }
  return next;
}

}  // namespace chimera::subsystem
