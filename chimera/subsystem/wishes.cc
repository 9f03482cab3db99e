// SPDX-License-Identifier: Apache-2.0
#include "chimera/subsystem/wishes.h"

#include <algorithm>

namespace chimera::subsystem {

void Wishes::add(const Commanded& command) {
  queue_.push_back({{command.id, at_.sorted(command.tasks), TaskId{}, false}, at_.now, false});
}

void Wishes::add(const Requested& request) {
  const std::size_t n = at_.spec.tasks.size();
  if (request.task.index >= n || request.from.index >= n) return;
  for (const Waiting& waiting : queue_)
    if (waiting.wish.from == request.from && waiting.wish.tasks.front() == request.task) return;
  queue_.push_back({{0, {request.task}, request.from, false}, at_.now, false});
}

void Wishes::advance() {
  if (!at_.is_complete) return;
  while (!transaction_.is_under_way()) {
    if (goals_.any(kGoalOn) && !goals_.any(kGoalSpawn)) {
      if (!begin_goals()) return;
      continue;
    }
    const auto try_it = [this](Waiting& waiting) { return try_begin(waiting); };
    const auto begun = std::find_if(queue_.begin(), queue_.end(), try_it);
    if (begun == queue_.end()) return;
    queue_.erase(begun);
  }
}

// One that was killed or failed since it was spawned is left out; whether the rest is legal is judged next.
bool Wishes::begin_goals() {
  for (TaskId task : goals_.with(kGoalOn)) {
    const State state = at_.roster.state(task);
    if (at_.roster.life_of(task) != Life::kUp || at_.is_busy(task) || state == State::kOn || state == State::kOff)
      continue;
    goals_.fail(task, "refused", at_.illegal(Signal::kOn, task, state, {&task, 1}));
  }
  OnWish wish{0, goals_.with(kGoalOn), TaskId{}, true};
  if (wish.tasks.empty()) return true;
  for (TaskId task : wish.tasks)
    if (at_.roster.life_of(task) != Life::kUp) return false;
  if (must_wait(wish.tasks)) return false;
  transaction_.begin(std::move(wish));
  transaction_.advance();
  return true;
}

// Whoever is on the way to OFF may still be a producer: better wait than refuse.
bool Wishes::must_wait(const std::vector<TaskId>& tasks) const {
  if (std::any_of(tasks.begin(), tasks.end(), [this](TaskId task) { return at_.is_busy(task); })) return true;
  return std::any_of(at_.order.begin(), at_.order.end(), [this](TaskId task) {
    return at_.may_be_on(task) && (at_.mail.is_awaited(task, Signal::kOff) || at_.mail.is_awaited(task, Signal::kKill));
  });
}

// True: it is no longer in the queue, begun or refused.
bool Wishes::try_begin(Waiting& waiting) {
  const auto& tasks = waiting.wish.tasks;
  if (tasks.empty()) {
    accept(waiting);
    return true;
  }
  if (std::any_of(tasks.begin(), tasks.end(), [this](TaskId task) { return goals_.is_pursued(task); })) {
    waiting.has_waited = true;
    return false;
  }
  if (waiting.has_waited && are_all_on(tasks)) {
    accept(waiting);
    return true;
  }
  const Nanoseconds limit = due(waiting);
  if (limit <= at_.now) {
    const auto mute = std::find_if(tasks.begin(), tasks.end(),
                                   [this](TaskId task) { return at_.roster.life_of(task) == Life::kUnknown; });
    transaction_.refuse(waiting.wish, *mute, at_.no_answer(*mute));
    return true;
  }
  if (limit != kNever || must_wait(tasks)) return false;
  transaction_.begin(waiting.wish);
  transaction_.advance();
  return true;
}

// Of a process that lives but does not serve; one that is dead has no task that may go ON.
Nanoseconds Wishes::due(const Waiting& waiting) const noexcept {
  const auto& tasks = waiting.wish.tasks;
  const bool is_mute = std::any_of(tasks.begin(), tasks.end(),
                                   [this](TaskId task) { return at_.roster.life_of(task) == Life::kUnknown; });
  return is_mute ? std::max(waiting.arrived, at_.complete_since) + kAnswerLimit : kNever;
}

bool Wishes::are_all_on(const std::vector<TaskId>& tasks) const noexcept {
  return std::all_of(tasks.begin(), tasks.end(), [this](TaskId task) { return at_.roster.state(task) == State::kOn; });
}

void Wishes::accept(const Waiting& waiting) const {
  if (waiting.wish.id == 0) return;
  Answer answer{waiting.wish.id, true, {}, TaskId{}, {}};
  for (TaskId task : waiting.wish.tasks) answer.outcomes.push_back({task, State::kOff, at_.roster.state(task), false});
  at_.act(std::move(answer));
}

Nanoseconds Wishes::next_due() const noexcept {
  Nanoseconds next = kNever;
  if (!at_.is_complete) return next;
  for (const Waiting& waiting : queue_) {
    const bool waits_for_goals = std::any_of(waiting.wish.tasks.begin(), waiting.wish.tasks.end(),
                                             [this](TaskId task) { return goals_.is_pursued(task); });
    if (!waits_for_goals && !transaction_.is_under_way()) next = std::min(next, due(waiting));
  }
  return next;
}

}  // namespace chimera::subsystem
