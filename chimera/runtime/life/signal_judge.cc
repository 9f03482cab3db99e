// SPDX-License-Identifier: Apache-2.0
// Judges signals by the tasks of all contexts.
#include "chimera/runtime/life/signal_judge.h"

#include <algorithm>

#include "chimera/runtime/life/task_set.h"
#include "chimera/runtime/set_equations.h"

namespace chimera {

void SignalJudge::prepare(const ApplicationSpec& spec, SetupMemory& memory) {
  rivals_.prepare(spec, memory);
  wanted_ = memory.take<bool>(spec.tasks.size());
}

Refusal SignalJudge::judge(std::span<const TaskId> tasks, Signal signal) noexcept {
  if (signal == Signal::kSpawn) {
    for (const TaskId id : tasks)
      if (find_rival(id).is_valid() || !claims_resource_of(id)) return Refusal::kRival;
    return Refusal::kNone;
  }
  if (signal != Signal::kOn) return Refusal::kNone;
  // Where there is a manager, it alone turns tasks ON, and has judged the whole set.
  const bool is_judged = set_.others() != nullptr && set_.others()->has_manager();
  if (!is_judged && !would_be_legal(tasks)) return Refusal::kIllegalSet;
  return claims_groups_of(tasks) ? Refusal::kNone : Refusal::kIllegalSet;
}

TaskId SignalJudge::find_rival(TaskId task) const noexcept {
  if (!rivals_.is_any()) return {};
  for (const Task& each : set_.tasks()) {
    if (!rivals_.are(task, each.id)) continue;
    const bool is_mine = set_.is_mine(each.id);
    const bool is_held = is_mine ? each.state != State::kNotCreated || each.in_service()
                                 : set_.others()->presence(each.id).is_held;
    if (is_held) return each.id;
  }
  return {};
}

// A primary and its standby with one resource may be created by two contexts at a time.
bool SignalJudge::claims_resource_of(TaskId task) noexcept {
  const Standbys& standbys = set_.standbys();
  const std::size_t group = rivals_.is_any() ? standbys.group_of(task) : standbys.n_groups();
  if (group == standbys.n_groups() || set_.others() == nullptr) return true;
  const auto mates = standbys.members(group);
  const auto is_rival = [&](TaskId mate) { return rivals_.are(task, mate); };
  if (std::none_of(mates.begin(), mates.end(), is_rival)) return true;
  if (set_.others()->claim(group) && !find_rival(task).is_valid()) return true;
  set_.changes().add_flag();  // so that something is shown, which ends the claim
  return false;
}

// Tasks that stand in for each other may be turned ON by several contexts: the one that has the claim looks once more.
bool SignalJudge::claims_groups_of(std::span<const TaskId> tasks) noexcept {
  if (set_.others() == nullptr) return true;
  const Standbys& standbys = set_.standbys();
  for (const TaskId id : tasks) {
    const std::size_t group = standbys.group_of(id);
    if (group == standbys.n_groups()) continue;
    const auto is_on = [&](TaskId mate) {
      const State state = set_.is_mine(mate) ? set_.tasks()[mate.index].shown_state() : set_.others()->state(mate);
      return mate != id && state == State::kOn;
    };
    const auto mates = standbys.members(group);
    if (set_.others()->claim(group) && std::none_of(mates.begin(), mates.end(), is_on)) continue;
    set_.changes().add_flag();  // so that something is shown, which ends the claim
    return false;
  }
  return true;
}

bool SignalJudge::would_be_legal(std::span<const TaskId> tasks) noexcept {
  for (const Task& task : set_.tasks())
    wanted_[task.id.index] = (set_.is_mine(task.id) ? task.shown_state() : set_.others()->state(task.id)) == State::kOn;
  if constexpr (mechanisms::kStandbys) set_.standbys().add_covered(wanted_, tasks);
  for (TaskId id : tasks) wanted_[id.index] = true;
  if (is_legal_set(set_.spec().variables, wanted_)) return true;
  if constexpr (!mechanisms::kStandbys) return false;
  // The producers of a standby's inputs may have failed with its primary: the last values stand, and the flag is up.
  const Standbys& standbys = set_.standbys();
  const std::size_t group = tasks.size() == 1 ? standbys.group_of(tasks[0]) : standbys.n_groups();
  if (group == standbys.n_groups() || standbys.next(group) != tasks[0]) return false;
  const auto is_on = [this](TaskId task) -> bool { return wanted_[task.index]; };
  const auto is_doubled = [&](const Variable& variable) {
    return set_fault(variable, is_on) == SetFault::kTwoProducers;
  };
  return std::none_of(set_.spec().variables.begin(), set_.spec().variables.end(), is_doubled);
}

std::uint32_t SignalJudge::living() const noexcept {
  std::uint32_t contexts = 0;
  for (const Task& task : set_.tasks())
    if (set_.is_mine(task.id) || set_.others()->presence(task.id).lives)
      contexts |= 1u << (task.spec->rtpu.index % 32);
  return contexts;
}

}  // namespace chimera
