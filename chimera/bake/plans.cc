// SPDX-License-Identifier: Apache-2.0
// Makes one plan for each ordered pair of configurations.
#include "chimera/bake/plans.h"

#include "chimera/runtime/hosted/heap_memory.h"
#include "chimera/runtime/plan/switch_schedule.h"

namespace chimera::bake {
namespace {

/// The tasks with the times of the profile for budgets: those alone count on the target.
std::vector<TaskSpec> timed(std::span<const TaskSpec> tasks, const RecordedProfile* profile) {
  std::vector<TaskSpec> all(tasks.begin(), tasks.end());
  for (TaskSpec& task : all) {
    const RecordedTask* const recorded = profile == nullptr ? nullptr : profile->find(task.name);
    task.budget = recorded == nullptr ? Nanoseconds{} : recorded->worst;
  }
  return all;
}

}  // namespace

BakedPlans::BakedPlans(const ApplicationSpec& spec, const RecordedProfile* profile) {
  const std::size_t n = spec.sets.size();
  if (n < 2) return;
  const std::vector<TaskSpec> tasks = timed(spec.tasks, profile);
  ApplicationSpec judged = spec;
  judged.tasks = tasks;
  judged.plans = nullptr;
  HeapMemory memory;
  SwitchPlanner planner;
  SwitchSchedule schedule;
  planner.prepare(judged, memory);
  schedule.prepare(judged, memory);
  plans_.resize(n * n);
  std::vector<TaskStatus> statuses(spec.tasks.size());
  for (std::uint32_t before = 0; before < n; ++before) {
    const TaskBits on = tasks_of(spec, before);
    for (std::size_t t = 0; t < statuses.size(); ++t)
      statuses[t] = {on.has(TaskId(t)) ? State::kOn : State::kOff, false};
    for (std::uint32_t after = 0; after < n; ++after) {
      SwitchPlan& plan = plans_[before * n + after];
      if (!planner.plan(after, statuses, plan)) continue;
      plan.arriving = kept(tasks_, plan.arriving);
      plan.leaving = kept(tasks_, plan.leaving);
      plan.staying = kept(tasks_, plan.staying);
      plan.handovers = kept(handovers_, plan.handovers);
      plan.deadline = &deadlines_.emplace_back(schedule.judge(statuses, tasks_of(spec, after)));
    }
  }
}

}  // namespace chimera::bake
