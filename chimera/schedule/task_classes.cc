// SPDX-License-Identifier: Apache-2.0
// Sorts tasks into classes of one rate, and keeps the active members of each in the order of urgency.
#include "chimera/schedule/task_classes.h"

#include <algorithm>

#include "chimera/base/assert.h"

namespace chimera {

std::size_t TaskClasses::count(std::span<const TaskSpec> tasks) noexcept {
  std::size_t n = 0;
  for (std::size_t i = 0; i < tasks.size(); ++i) {
    const auto is_of_it = [&](const TaskSpec& t) {
      return t.period == tasks[i].period && t.offset == tasks[i].offset;
    };
    if (std::none_of(tasks.begin(), tasks.begin() + static_cast<std::ptrdiff_t>(i), is_of_it)) ++n;
  }
  return n;
}

TaskClasses::TaskClasses(Policy policy, std::span<const TaskSpec> tasks, const Storage& storage) noexcept
    : policy_(policy), tasks_(tasks), storage_(storage) {
  const std::size_t n = tasks.size();
  CHIMERA_ASSERT(storage.members.size() >= n && storage.class_of.size() >= n);
  CHIMERA_ASSERT(storage.classes.size() >= count(tasks));
  std::uint32_t filled = 0, n_classes = 0;
  for (std::uint32_t first = 0; first < n; ++first) storage_.class_of[first] = UINT32_MAX;
  for (std::uint32_t first = 0; first < n; ++first) {
    if (storage_.class_of[first] != UINT32_MAX) continue;
    CHIMERA_ASSERT(tasks[first].period > Nanoseconds{});
    TaskClass& c = storage_.classes[n_classes];
    c = TaskClass{};
    c.period = tasks[first].period;
    c.offset = tasks[first].offset;
    c.begin = filled;
    for (std::uint32_t i = first; i < n; ++i) {
      const TaskSpec& t = tasks[i];
      if (t.period != c.period || t.offset != c.offset) continue;
      storage_.class_of[i] = n_classes;
      storage_.members[filled++] = ClassMember{t.deadline, t.budget, kNever, i, t.criticality, t.user_priority};
    }
    c.size = filled - c.begin;
    ++n_classes;
  }
}

const ClassMember& TaskClasses::member_of(std::uint32_t task) const noexcept {
  return member(storage_.classes[class_of(task)], place(task));
}

std::uint32_t TaskClasses::place(std::uint32_t task) const noexcept {
  const TaskClass& c = storage_.classes[class_of(task)];
  std::uint32_t at = 0;
  while (member(c, at).task != task) ++at;
  return at;
}

bool TaskClasses::is_active(std::uint32_t task) const noexcept {
  return place(task) < storage_.classes[class_of(task)].active;
}

Nanoseconds TaskClasses::grid_at_or_after(const TaskClass& c, Nanoseconds now) const noexcept {
  const Nanoseconds first = origin_ + c.offset;
  if (now <= first) return first;
  return first + c.period * ((now - first + c.period - Nanoseconds{1}) / c.period);
}

void TaskClasses::activate(std::uint32_t task, Nanoseconds now) noexcept {
  TaskClass& c = storage_.classes[class_of(task)];
  const bool has_run = c.cursor < c.active;
  const auto members = storage_.members.subspan(c.begin, c.size);
  const std::uint32_t from = place(task);
  ClassMember m = members[from];
  m.first = grid_at_or_after(c, now);
  if (c.active > 0) m.first = std::max(m.first, c.next);  // the release of this instant may be running already
  members[from] = members[c.active];
  std::uint32_t to = c.active;
  for (; to > 0; --to) {
    const ClassMember& other = members[to - 1];
    if (goes_before(urgency(c, other), other.task, urgency(c, m), m.task)) break;
    members[to] = other;
  }
  members[to] = m;
  ++c.active;
  if (to < c.cursor || !has_run) ++c.cursor;
  if (c.active > 1) return;
  c.cursor = 1;
  c.next = m.first;
}

void TaskClasses::deactivate(std::uint32_t task) noexcept {
  TaskClass& c = storage_.classes[class_of(task)];
  const auto members = storage_.members.subspan(c.begin, c.size);
  const std::uint32_t at = place(task);
  const ClassMember m = members[at];
  --c.active;
  for (std::uint32_t i = at; i < c.active; ++i) members[i] = members[i + 1];
  members[c.active] = m;
  if (at < c.cursor) --c.cursor;
}

Urgency TaskClasses::urgency(std::uint32_t index) const noexcept {
  const TaskClass& c = storage_.classes[index];
  return urgency(c, member(c, c.cursor));
}

std::uint32_t TaskClasses::task_at_cursor(std::uint32_t index) const noexcept {
  const TaskClass& c = storage_.classes[index];
  return member(c, c.cursor).task;
}

bool TaskClasses::goes_before(const Urgency& a, std::uint32_t a_task, const Urgency& b,
                              std::uint32_t b_task) const noexcept {
  if (is_more_urgent(policy_, a, b)) return true;
  if (is_more_urgent(policy_, b, a)) return false;
  return tie_of(tasks_[a_task].place, a_task) < tie_of(tasks_[b_task].place, b_task);
}

bool TaskClasses::run_goes_before(std::uint32_t a, std::uint32_t b) const noexcept {
  return goes_before(urgency(a), task_at_cursor(a), urgency(b), task_at_cursor(b));
}

}  // namespace chimera
