// SPDX-License-Identifier: Apache-2.0
// Picks the next request for `on` that may begin, and refuses one that waited for its rtpu for too long.
#include "chimera/subsystem/on_queue.h"

#include <algorithm>

namespace chimera::subsystem {

void OnQueue::add(const Commanded& command) {
  for (TaskId task : command.tasks) goals_.clear(task, kGoalOff);
  queue_.push_back({{command.id, state_.sorted(command.tasks), TaskId{}, false}, state_.now});
}

void OnQueue::add(const Requested& request) {
  const std::size_t n = state_.spec.tasks.size();
  if (request.task.index >= n || request.from.index >= n) return;
  for (const Waiting& waiting : queue_)
    if (waiting.request.from == request.from && waiting.request.tasks.front() == request.task) return;
  const OnRequest asked{0, {request.task}, request.from, false};
  if (!goals_.has(request.task, kGoalOff)) return queue_.push_back({asked, state_.now});
  const std::string name = state_.name(request.task);
  const std::string remedy = "`chimera on " + name + "` turns it ON";
  transaction_.refuse(asked, request.task, {RefusalKind::kState, "an operator turned " + name + " OFF", remedy});
}

bool OnQueue::advance() {
  bool changed = false;
  while (!transaction_.is_under_way()) {
    if (goals_.any(kGoalOn) && !goals_.any(kGoalSpawn)) {
      changed = fail_lost_goals() || changed;
      if (!try_begin_goals()) return changed;
    } else {
      const auto begun = std::ranges::find_if(queue_, [this](Waiting& waiting) { return try_begin(waiting); });
      if (begun == queue_.end()) return changed;
      queue_.erase(begun);
    }
    changed = true;
  }
  return changed;
}

// Leaves out a task that was killed or failed after its spawn, or whose standby is ON. The transaction then judges if
// the rest is legal.
bool OnQueue::fail_lost_goals() {
  bool changed = false;
  for (TaskId task : goals_.with(kGoalOn)) {
    const State state = state_.observed.state(task);
    if (state != State::kOn && is_replaced(task)) {
      changed = goals_.clear(task, kGoalOn) || changed;
      continue;
    }
    const bool is_known = state_.observed.life_of(task) == RtpuLife::kUp && !state_.is_busy(task);
    if (!is_known || state == State::kOn || state == State::kOff) continue;
    goals_.fail(task, state_.illegal(Signal::kOn, task, state, {&task, 1}));
    changed = true;
  }
  return changed;
}

bool OnQueue::is_replaced(TaskId task) const noexcept {
  for (std::size_t t = 0; t < state_.spec.tasks.size(); ++t)
    if (state_.spec.stand_in(task, TaskId(t)) && state_.observed.state(TaskId(t)) == State::kOn) return true;
  return false;
}

// True if a transaction began or no goal is left.
bool OnQueue::try_begin_goals() {
  OnRequest request{0, goals_.with(kGoalOn), TaskId{}, true};
  const auto is_up = [this](TaskId task) { return state_.observed.life_of(task) == RtpuLife::kUp; };
  if (!std::ranges::all_of(request.tasks, is_up) || (!request.tasks.empty() && must_wait(request.tasks))) return false;
  if (!request.tasks.empty()) begin(std::move(request));
  return true;
}

void OnQueue::begin(OnRequest request) {
  transaction_.begin(std::move(request));
  (void)transaction_.advance();
}

// `on` waits while a rival goes OFF: until then the rival may still be a producer.
bool OnQueue::must_wait(const std::vector<TaskId>& tasks) const {
  if (std::any_of(tasks.begin(), tasks.end(), [this](TaskId task) { return state_.is_busy(task); })) return true;
  return std::any_of(state_.spec.on_order.begin(), state_.spec.on_order.end(), [this](TaskId task) {
    return state_.may_be_on(task) &&
           (state_.pending.is_awaited(task, Signal::kOff) || state_.pending.is_awaited(task, Signal::kKill));
  });
}

// True if the request left the queue: it began or was refused.
bool OnQueue::try_begin(Waiting& waiting) {
  const auto& tasks = waiting.request.tasks;
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
  if (limit <= state_.now) {
    const auto mute = std::find_if(tasks.begin(), tasks.end(),
                                   [this](TaskId task) { return state_.observed.life_of(task) == RtpuLife::kUnknown; });
    transaction_.refuse(waiting.request, *mute, state_.no_answer(*mute));
    return true;
  }
  if (limit != kNever || must_wait(tasks)) return false;
  begin(waiting.request);
  return true;
}

// Time until which the request waits for a process that lives but does not serve. A dead process is not waited for:
// none of its tasks may go ON.
Nanoseconds OnQueue::due(const Waiting& waiting) const noexcept {
  const auto& tasks = waiting.request.tasks;
  const bool is_mute = std::any_of(tasks.begin(), tasks.end(),
                                   [this](TaskId task) { return state_.observed.life_of(task) == RtpuLife::kUnknown; });
  return is_mute ? std::max(waiting.arrived, state_.complete_since) + kAnswerLimit : kNever;
}

bool OnQueue::are_all_on(const std::vector<TaskId>& tasks) const noexcept {
  return std::all_of(tasks.begin(), tasks.end(),
                     [this](TaskId task) { return state_.observed.state(task) == State::kOn; });
}

void OnQueue::accept(const Waiting& waiting) const {
  if (waiting.request.id == 0) return;
  CommandAnswer answer{waiting.request.id, {}, TaskId{}, {}};
  for (TaskId task : waiting.request.tasks)
    answer.outcomes.push_back({task, State::kOff, state_.observed.state(task), false});
  state_.emit(std::move(answer));
}

Nanoseconds OnQueue::next_due() const noexcept {
  Nanoseconds next = kNever;
  for (const Waiting& waiting : queue_) {
    const bool waits_for_goals = std::any_of(waiting.request.tasks.begin(), waiting.request.tasks.end(),
                                             [this](TaskId task) { return goals_.is_pursued(task); });
    if (!waits_for_goals && !transaction_.is_under_way()) next = std::min(next, due(waiting));
  }
  return next;
}

}  // namespace chimera::subsystem
