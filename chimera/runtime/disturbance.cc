// SPDX-License-Identifier: Apache-2.0
// Holds tasks, flag and members against what the plan of a switch was made from.
#include "chimera/runtime/disturbance.h"

namespace chimera {

Disturbance find_disturbance(TaskSet& set, const SwitchPlan& plan, std::size_t n_armed,
                             const UndisturbedState& before, const SwitchPeers& peers) noexcept {
  for (std::size_t i = 0; i < plan.arriving.size(); ++i) {
    const Task& each = set.tasks()[plan.arriving[i].index];
    const bool is_off = each.state == State::kOff && !each.in_service;
    if (set.is_mine(each.id) && !(is_off && each.owes_off == (i < n_armed))) return {NoSwitch::kDisturbed, each.id};
  }
  for (const auto ids : {plan.leaving, plan.staying})
    for (const TaskId id : ids)
      if (set.is_mine(id) && set.tasks()[id.index].state != State::kOn) return {NoSwitch::kDisturbed, id};
  const IllegalFlag& flag = set.flag();
  if ((flag.is_up() && !before.flag_was_up) || (flag.is_raised() && !before.flag_was_raised))
    return {NoSwitch::kFlagRaised, flag.raised_by()};
  if ((before.members & ~peers.living()) != 0) return {NoSwitch::kMemberDied, {}};
  return {};
}

}  // namespace chimera
