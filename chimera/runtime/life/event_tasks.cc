// SPDX-License-Identifier: Apache-2.0
// Counts events of tasks and releases a job for each.
#include "chimera/runtime/life/event_tasks.h"

#include <algorithm>

namespace chimera {

void EventTasks::add(Task& task) noexcept {
  for (EventTask& one : tasks_) {
    if (one.task != nullptr) continue;
    one.task = &task;
    task.by_events = true;
    return;
  }
}

void EventTasks::begin(Nanoseconds origin) noexcept {
  if (parts_.inputs != nullptr && !tasks_.empty()) next_tick_ = origin;
}

EventTasks::EventTask* EventTasks::find(TaskId task) noexcept {
  if constexpr (!mechanisms::kEvents) return nullptr;
  for (EventTask& one : tasks_)
    if (one.task->id == task) return &one;
  return nullptr;
}

bool EventTasks::join(Task& task, Nanoseconds now) noexcept {
  EventTask* const one = find(task.id);
  if (one == nullptr) return false;
  task.by_events = parts_.inputs != nullptr || task.descriptor < 0;
  one->last = std::max(one->last, now - task.spec->period);
  return task.by_events;
}

void EventTasks::leave(Task& task) noexcept {
  EventTask* const one = find(task.id);
  if (one == nullptr || !task.by_events) return;
  Job waiting;
  if (one->is_ready && parts_.queue.remove(task.id, waiting)) ++task.profile.events_lost;
  one->last = one->last - task.spec->period * std::int64_t{one->noticed};
  one->noticed = 0;
  one->is_ready = false;
  look_ahead();
}

void EventTasks::follow(Nanoseconds now) noexcept {
  parts_.sent.had_rings();
  if (next_tick_ <= now) read_inputs(now);
  for (EventTask& one : tasks_) release(one, now);
  look_ahead();
}

void EventTasks::read_inputs(Nanoseconds now) noexcept {
  next_tick_ = next_tick_ + parts_.tick;
  if (next_tick_ <= now) next_tick_ = next_tick_ + parts_.tick * ((now - next_tick_) / parts_.tick + 1);
  for (EventTask& one : tasks_) {
    Task& task = *one.task;
    const std::uint32_t fresh = parts_.inputs->take(task, one.is_ready || task.events > 0);
    if (fresh == 0) continue;
    const bool counts = task.state == State::kOn && task.events <= UINT32_MAX - fresh;
    if (counts) task.events += fresh;
    (counts ? task.profile.events : task.profile.events_lost) += fresh;
  }
}

// The first event of a burst is released now, or one period after the previous event. The others follow.
void EventTasks::release(EventTask& one, Nanoseconds now) noexcept {
  Task& task = *one.task;
  if (!task.by_events || task.state != State::kOn) return;
  const Nanoseconds period = task.spec->period;
  if (const std::uint32_t fresh = task.events - one.noticed; fresh > 0) {
    one.last = std::max(now, one.last + period) + period * (std::int64_t{fresh} - 1);
    one.noticed = task.events;
  }
  if (one.noticed == 0 || one.is_ready || one.next() > now) return;
  const Nanoseconds at = one.next();
  parts_.queue.put_back({task.id, at, at + task.spec->deadline}, task.spec->budget);
  // The end of this job, or its drop, must lead to finish().
  SharedWord<std::uint8_t>& left = parts_.records[task.id.index].left;
  left.store(static_cast<std::uint8_t>(left.load(std::memory_order_relaxed) | JobRecord::kSettle),
             std::memory_order_relaxed);
  one.is_ready = true;
  --one.noticed;
  --task.events;
}

void EventTasks::finish(TaskId task) noexcept {
  EventTask* const one = find(task);
  if (one == nullptr) return;
  one->is_ready = false;
  look_ahead();
}

void EventTasks::look_ahead() noexcept {
  due_ = kNever;
  for (const EventTask& one : tasks_)
    if (one.noticed > 0 && !one.is_ready) due_ = std::min(due_, one.next());
}

Nanoseconds EventTasks::oldest(TaskId task) const noexcept {
  for (const EventTask& one : tasks_) {
    if (one.task->id != task) continue;
    if (one.is_ready) return one.next() - one.task->spec->period;
    return one.noticed > 0 ? one.next() : kNever;
  }
  return kNever;
}

}  // namespace chimera
