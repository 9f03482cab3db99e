// SPDX-License-Identifier: Apache-2.0
// Lists the steps of a slow switch.
#include "chimera/runtime/slow_plan.h"

#include <algorithm>

namespace chimera {

void SlowPlanner::prepare(const ApplicationSpec& spec, SetupMemory& memory) {
  users_.prepare(spec, memory);
  steps_ = memory.take<SlowStep>(3 * spec.tasks.size());  // who arrives and uses constants has three
}

std::span<const SlowStep> SlowPlanner::plan(const SwitchPlan& plan, std::uint32_t constants) noexcept {
  std::size_t n = 0;
  const auto add = [&](SlowAct act, std::span<const TaskId> tasks) {
    for (const TaskId task : tasks) steps_[n++] = {act, task};
  };
  const std::span<const TaskId> users = users_.find(plan, constants, nullptr);
  add(SlowAct::kCheck, users);
  add(SlowAct::kOff, plan.leaving);
  add(SlowAct::kReinit, users);
  add(SlowAct::kOn, plan.arriving);
  return steps_.first(n);
}

Nanoseconds flag_lead(const ApplicationSpec& spec, const TaskBits& on) noexcept {
  Nanoseconds lead;
  for (std::size_t t = 0; t < spec.tasks.size(); ++t) {
    const TaskSpec& task = spec.tasks[t];
    if (task.is_hardware && !task.aperiodic && on.has(TaskId(t))) lead = std::max(lead, task.period);
  }
  return lead;
}

}  // namespace chimera
