// SPDX-License-Identifier: Apache-2.0
// Follows the task that is ON in each group of a primary and its standbys, and the task that takes over.
#include "chimera/runtime/plan/standbys.h"

#include <algorithm>

namespace chimera {

void Standbys::prepare(const ApplicationSpec& spec, const Rivals& rivals, SetupMemory& memory) {
  if constexpr (!mechanisms::kStandbys) return;
  tasks_ = spec.tasks;
  rivals_ = &rivals;
  is_covered_ = memory.take<bool>(spec.tasks.size());
  is_out_ = memory.take<bool>(spec.tasks.size());
  states_ = memory.take<State>(spec.tasks.size());
  is_hot_ = memory.take<bool>(spec.tasks.size());
  is_cool_ = memory.take<bool>(spec.tasks.size());
  for (const StandbySpec& each : spec.standbys) {
    is_hot_[each.standby.index] = each.hot;
    has_hot_ = has_hot_ || each.hot;
  }
  const auto is_first = [&](std::size_t i) {
    const auto before = spec.standbys.first(i);
    return std::none_of(before.begin(), before.end(),
                        [&](const StandbySpec& other) { return other.primary == spec.standbys[i].primary; });
  };
  std::size_t n_groups = 0;
  for (std::size_t i = 0; i < spec.standbys.size(); ++i) n_groups += is_first(i) ? 1 : 0;
  groups_ = memory.take<Group>(n_groups);
  members_ = memory.take<TaskId>(n_groups + spec.standbys.size());
  std::size_t g = 0, m = 0;
  for (std::size_t i = 0; i < spec.standbys.size(); ++i) {
    if (!is_first(i)) continue;
    const std::size_t begin = m;
    members_[m++] = spec.standbys[i].primary;
    for (const StandbySpec& each : spec.standbys)
      if (each.primary == spec.standbys[i].primary) members_[m++] = each.standby;
    groups_[g++].members = members_.subspan(begin, m - begin);
  }
}

void Standbys::follow(std::span<const State> states, std::uint32_t living, Nanoseconds now) noexcept {
  living_ = living;
  std::copy(states.begin(), states.end(), states_.begin());
  for (Group& group : groups_) follow(group, now);
  sum_up(now);
}

void Standbys::follow(Group& group, Nanoseconds now) noexcept {
  const auto on = std::find_if(group.members.begin(), group.members.end(),
                               [this](TaskId id) { return state(id) == State::kOn; });
  if (on != group.members.end()) return gain(group, *on, now);
  if (!group.on.is_valid()) return;
  const bool is_in_error = state(group.on) == State::kError;
  if (!group.is_lost && is_in_error) lose(group, now);
  if (group.is_lost) group.is_waiting = group.is_waiting && next(group).is_valid();
  // Turned OFF, or cleared when no task could take over any more.
  if (!is_in_error && !group.is_waiting) {
    group.on = TaskId();
    group.is_lost = false;
  }
}

void Standbys::gain(Group& group, TaskId on, Nanoseconds now) noexcept {
  if (group.is_lost && on != group.on) {
    std::move(group.taken_over + 1, group.taken_over + kMostTakeovers, group.taken_over);
    group.taken_over[kMostTakeovers - 1] = now;
  }
  if (on != group.on)
    for (const TaskId id : group.members) is_cool_[id.index] = false;
  group.on = on;
  group.is_lost = group.is_waiting = false;
  for (const TaskId id : group.members) is_out_[id.index] = false;
}

void Standbys::lose(Group& group, Nanoseconds now) noexcept {
  const TaskId by = next(group);
  const bool is_too_often = group.taken_over[0] > now - kWindow;
  group.is_lost = true;
  group.is_waiting = by.is_valid() && !is_too_often;
  group.loss = {group.on, now, group.is_waiting ? now + tasks_[by.index].period : now};
}

void Standbys::sum_up(Nanoseconds now) noexcept {
  is_any_uncovered_ = is_any_waiting_ = false;
  due_ = kNever;
  for (const Group& group : groups_) {
    for (const TaskId id : group.members) is_covered_[id.index] = false;
    if (!group.is_lost) continue;
    const bool is_covered = group.is_waiting && now < group.loss.covered_until;
    is_covered_[group.on.index] = is_covered;
    is_any_uncovered_ = is_any_uncovered_ || !is_covered;
    is_any_waiting_ = is_any_waiting_ || group.is_waiting;
    if (is_covered) due_ = std::min(due_, group.loss.covered_until);
  }
}

void Standbys::follow_switch(const TaskBits& target) noexcept {
  for (Group& group : groups_) {
    if (std::any_of(group.members.begin(), group.members.end(), [&](TaskId id) { return target.has(id); })) continue;
    group.on = TaskId();
    group.is_lost = group.is_waiting = false;
  }
}

TaskId Standbys::next(std::size_t group) const noexcept {
  return groups_[group].is_waiting ? next(groups_[group]) : TaskId();
}

TaskId Standbys::next(const Group& group) const noexcept {
  const auto is_creatable = [&](TaskId id) {
    const std::uint32_t context = tasks_[id.index].rtpu.index % 32;
    return state(id) == State::kNotCreated && rivals_->are(id, group.on) && (living_ >> context & 1u) != 0;
  };
  const auto can = [&](TaskId id) {
    return id != group.on && (state(id) == State::kOff || is_creatable(id)) && !is_out_[id.index];
  };
  const auto found = std::find_if(group.members.begin(), group.members.end(), can);
  return found == group.members.end() ? TaskId() : *found;
}

std::size_t Standbys::group_of(TaskId task) const noexcept {
  std::size_t group = 0;
  while (group < groups_.size() && !has(groups_[group], task)) ++group;
  return group;
}

bool Standbys::is_awaited(TaskId task) const noexcept {
  return std::any_of(groups_.begin(), groups_.end(),
                     [task](const Group& group) { return group.is_waiting && group.on == task; });
}

void Standbys::add_covered(std::span<bool> on, std::span<const TaskId> beside) const noexcept {
  for (const Group& group : groups_) {
    if (!group.is_lost || !is_covered_[group.on.index]) continue;
    if (std::none_of(beside.begin(), beside.end(), [&](TaskId id) { return has(group, id); }))
      on[group.on.index] = true;
  }
}

bool Standbys::is_replaced(TaskId task) const noexcept {
  return std::any_of(groups_.begin(), groups_.end(), [&](const Group& group) {
    return !group.is_lost && group.on.is_valid() && group.on != task && has(group, task);
  });
}

bool Standbys::keeps_warm(TaskId task) const noexcept {
  if (!is_hot_[task.index] || is_cool_[task.index]) return false;
  return std::any_of(groups_.begin(), groups_.end(), [&](const Group& group) {
    return group.on.is_valid() && group.on != task && has(group, task);
  });
}

bool Standbys::has(const Group& group, TaskId task) noexcept {
  return std::find(group.members.begin(), group.members.end(), task) != group.members.end();
}

}  // namespace chimera
