// SPDX-License-Identifier: Apache-2.0
// Decides between the ways of a switch.
#include "chimera/runtime/plan/switch_way.h"

#include <algorithm>

namespace chimera {

void SwitchWays::prepare(const ApplicationSpec& spec, SetupMemory& memory) {
  spec_ = &spec;
  rivals_.prepare(spec, memory);
  if constexpr (mechanisms::kTransitions) schedule_->prepare(spec, memory);
  users_.prepare(spec, memory);
}

SwitchWay SwitchWays::judge(const SwitchPlan& plan, std::span<const TaskStatus> statuses, std::uint32_t constants,
                            const MadeConstants& made, const NeededGaps& gaps) noexcept {
  SwitchWay way;
  if (plan.deadline != nullptr) way.deadline = *plan.deadline;
  else if constexpr (mechanisms::kTransitions) way.deadline = schedule_->judge(statuses, target_of(plan));
  if (!way.deadline) way.slow |= kSlowForDeadlines;
  way.constant = users_.find_staying(plan, constants, made);
  if (way.constant.task.is_valid()) way.slow |= kSlowForConstants;
  find_gapless(plan, statuses, gaps, way);
  for (const TaskId task : plan.arriving)
    if (statuses[task.index].state == State::kNotCreated && !way.absent.is_valid()) way.absent = task;
  if (!way.absent.is_valid()) return way;
  way.slow |= kSlowForResource;
  for (std::size_t t = 0; t < spec_->tasks.size(); ++t)
    if (rivals_.are(way.absent, TaskId(t)) && statuses[t].state != State::kNotCreated) way.rival = TaskId(t);
  return way;
}

// No gap of a loop is longer than the shortest period of its tasks that are ON.
void SwitchWays::find_gapless(const SwitchPlan& plan, std::span<const TaskStatus> statuses, const NeededGaps& gaps,
                              SwitchWay& way) const noexcept {
  for (const TaskId arriving : plan.arriving) {
    const TaskSpec& task = spec_->tasks[arriving.index];
    Nanoseconds longest_gap = kNever;
    for (std::size_t t = 0; t < statuses.size(); ++t) {
      const TaskSpec& other = spec_->tasks[t];
      const bool is_released = statuses[t].state == State::kOn && other.rtpu == task.rtpu && !other.aperiodic;
      if (is_released) longest_gap = std::min(longest_gap, other.period);
    }
    const Nanoseconds needed = gaps.for_on(arriving);
    if (needed <= longest_gap) continue;
    way.slow |= kSlowForGap;
    way.gapless = arriving;
    way.needed = needed;
    return;
  }
}

}  // namespace chimera
