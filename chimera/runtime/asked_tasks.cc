// SPDX-License-Identifier: Apache-2.0
// Finds the tasks that a request leads to.
#include "chimera/runtime/asked_tasks.h"

#include "chimera/base/assert.h"

namespace chimera {

TaskBits tasks_on(std::span<const TaskStanding> standing) noexcept {
  TaskBits on;
  for (std::size_t t = 0; t < standing.size(); ++t)
    if (standing[t].state == State::kOn) on.add(TaskId(t));
  return on;
}

bool find_target(SwitchRequest& request, const ApplicationSpec& spec, std::span<const TaskStanding> standing,
                 AskedTasks* asked, Nanoseconds now, TaskBits& target) noexcept {
  if (!request.lists.are_there()) {
    target = tasks_of(spec, request.set);
    return true;
  }
  CHIMERA_ASSERT(asked != nullptr);
  if (!asked->find(request, tasks_on(standing), now, target)) return false;
  request.set = set_of(spec, target);
  return true;
}

}  // namespace chimera
