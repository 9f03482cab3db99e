// SPDX-License-Identifier: Apache-2.0
// Decides between the ways of a switch.
#include "chimera/runtime/switch_way.h"

namespace chimera {

void SwitchWays::prepare(const ApplicationSpec& spec, SetupMemory& memory) {
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
  return way;
}

}  // namespace chimera
