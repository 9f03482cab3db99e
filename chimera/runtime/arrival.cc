// SPDX-License-Identifier: Apache-2.0
// Asks whether a task may go ON in a switch.
#include "chimera/runtime/arrival.h"

#include <algorithm>

namespace chimera {

bool holds(TaskSet& set, const SafeCondition& asked) noexcept {
  return !asked.is_there() || is_safe(asked, present_value(set, asked));
}

Followed follow_constants(TaskSet& set, const IdleGap& gap, Task& task, const SwitchOrder& order,
                          Nanoseconds now) noexcept {
  ContextConstants& constants = set.constants();
  if (!constants.has_choice()) return Followed::kNothing;
  constants.read_foreign();
  constants.put_in_force(order.constants_after());
  const bool is_behind = constants.uses_changed(task.id);
  const bool has_gap = !is_behind || gap.is_for(task, Method::kReinit, now);
  const std::uint64_t faults = task.faults.count;
  if (is_behind && has_gap) (void)set.life().move(task.id, Signal::kReinit, now);
  constants.put_in_force(order.constants);
  if (!has_gap) return Followed::kNoGap;
  if (!is_behind) return Followed::kNothing;
  return task.state == State::kOff && task.faults.count == faults ? Followed::kDone : Followed::kFailed;
}

bool cool_down(TaskSet& set, JobThreads& threads, Members& members, const SwitchPlan& plan, Nanoseconds now) noexcept {
  bool are_all = true;
  for (const TaskId id : plan.arriving) {
    Task& task = set.tasks()[id.index];
    if (!set.is_mine(id) || !task.is_unread) continue;
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

}  // namespace chimera
