// SPDX-License-Identifier: Apache-2.0
// Decides between the ways of a switch.
#include "chimera/runtime/switch_way.h"

namespace chimera {

void SwitchWays::prepare(const ApplicationSpec& spec, SetupMemory& memory) {
  spec_ = &spec;
  rivals_.prepare(spec, memory);
  schedule_.prepare(spec, memory);
  users_.prepare(spec, memory);
}

SwitchWay SwitchWays::judge(const SwitchPlan& plan, std::span<const TaskStanding> standing, std::uint32_t constants,
                            const MadeConstants& made) noexcept {
  SwitchWay way;
  way.deadline = schedule_.judge(standing, target_of(plan));
  if (!way.deadline) way.slow |= kSlowForDeadlines;
  way.constant = users_.find_staying(plan, constants, made);
  if (way.constant.task.is_valid()) way.slow |= kSlowForConstants;
  for (const TaskId task : plan.arriving)
    if (standing[task.index].state == State::kNotCreated && !way.absent.is_valid()) way.absent = task;
  if (!way.absent.is_valid()) return way;
  way.slow |= kSlowForResource;
  for (std::size_t t = 0; t < spec_->tasks.size(); ++t)
    if (rivals_.are(way.absent, TaskId(t)) && standing[t].state != State::kNotCreated) way.rival = TaskId(t);
  return way;
}

}  // namespace chimera
