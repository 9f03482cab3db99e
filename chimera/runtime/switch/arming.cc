// SPDX-License-Identifier: Apache-2.0
// Asks whether a task may go ON in a switch, and whether the switch is undisturbed.
#include "chimera/runtime/switch/arming.h"

#include <algorithm>

#include "chimera/runtime/job/job_step.h"
#include "chimera/runtime/switch/present_value.h"

namespace chimera {

bool holds(TaskSet& set, const SafeCondition& asked) noexcept {
  return !asked.is_there() || is_safe(asked, present_value(set, asked));
}

bool is_behind(TaskSet& set, const Task& task, const SwitchOrder& order) noexcept {
  ContextConstants& constants = set.constants();
  if (!constants.has_choice()) return false;
  constants.read_foreign();
  constants.put_in_force(order.constants_after());
  const bool is_behind = constants.uses_changed(task.id);
  constants.put_in_force(order.constants);
  return is_behind;
}

bool follow_constants(TaskSet& set, Task& task, const SwitchOrder& order, Nanoseconds now) noexcept {
  const std::uint64_t faults = task.faults.count;
  set.constants().put_in_force(order.constants_after());
  (void)set.life().move(task.id, Signal::kReinit, now);
  set.constants().put_in_force(order.constants);
  return task.state == State::kOff && task.faults.count == faults;
}

bool cool_down(TaskSet& set, JobThreads& threads, Members& members, const SwitchPlan& plan, Nanoseconds now) noexcept {
  bool are_all = true;
  for (const TaskId id : plan.arriving) {
    Task& task = set.tasks()[id.index];
    if (!set.is_mine(id) || !task.is_warm()) continue;
    if (!threads.claim(id)) {
      are_all = false;
      continue;
    }
    (void)set.life().signal(id, Signal::kOff, now);
    set.standbys().let_cool(id, false);
    members.follow(task, now);
  }
  return are_all;
}

VariableId missing_value(TaskSet& set, Task& task, std::span<const Handover> handovers) noexcept {
  read_inputs(task);
  const TaskMemory& memory = set.memory(task.id);
  for (std::size_t i = 0; i < task.inputs.size(); ++i) {
    if (memory.input_spec(i).intermittent) continue;
    const VariableId variable = memory.input_spec(i).variable;
    const auto is_its = [&](const Handover& handover) { return handover.variable == variable; };
    if (std::any_of(handovers.begin(), handovers.end(), is_its)) continue;
    const chimera_port& port = *task.inputs[i].port;
    if (((port.slot->valid >> port.bit) & 1u) == 0) return variable;
  }
  return {};
}

bool keeps_out(TaskSet& set, const SwitchOrder& order, std::span<const TaskId> tasks, Signal signal) noexcept {
  if (signal != Signal::kSpawn) return signal == Signal::kOn;
  const Rivals& rivals = set.life().judge().rivals();
  for (const Task& each : set.tasks()) {
    if (!order.on.has(each.id) && !order.target.has(each.id)) continue;
    for (const TaskId id : tasks)
      if (rivals.are(id, each.id)) return true;
  }
  return false;
}

Disturbance find_disturbance(TaskSet& set, const SwitchPlan& plan, std::size_t n_armed,
                             const UndisturbedState& before, const SwitchPeers& peers) noexcept {
  for (std::size_t i = 0; i < plan.arriving.size(); ++i) {
    const Task& each = set.tasks()[plan.arriving[i].index];
    const bool is_off = each.state == State::kOff && !each.in_service();
    const bool is_armed = each.standing == Standing::kOwesOff;
    if (set.is_mine(each.id) && !(is_off && is_armed == (i < n_armed))) return {NoSwitch::kDisturbed, each.id};
  }
  for (const auto ids : {plan.leaving, plan.staying})
    for (const TaskId id : ids)
      if (set.is_mine(id) && set.tasks()[id.index].state != State::kOn) return {NoSwitch::kDisturbed, id};
  for (const Task& each : set.tasks())
    if (set.is_mine(each.id) && each.shown_state() == State::kOn && !before.on.has(each.id))
      return {NoSwitch::kDisturbed, each.id};
  const IllegalFlag& flag = set.flag();
  if ((flag.is_up() && !before.flag_was_up) || (flag.is_raised() && !before.flag_was_raised))
    return {NoSwitch::kFlagRaised, flag.raised_by()};
  if ((before.members & ~peers.living()) != 0) return {NoSwitch::kMemberDied, {}};
  return {};
}

}  // namespace chimera
