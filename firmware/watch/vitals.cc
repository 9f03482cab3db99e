// SPDX-License-Identifier: Apache-2.0
// Judges tasks and stacks.
#include "firmware/watch/vitals.h"

namespace chimera::firmware {

VitalFault Vitals::judge(const Task& task, Seen& seen, Nanoseconds now) noexcept {
  if (task.state == State::kError && task.spec->criticality >= kHighCriticality) return VitalFault::kCritical;
  const auto cycles = static_cast<std::uint32_t>(task.profile.cycles);
  const bool is_on = task.state == State::kOn;
  const bool owes_nothing = task.spec->aperiodic && task.events == 0;
  if (!is_on || owes_nothing || cycles != seen.cycles) {
    seen.alive = now;
    seen.cycles = cycles;
    return VitalFault::kNone;
  }
  if (now - seen.alive <= task.spec->period * 2) return VitalFault::kNone;
  return task.spec->aperiodic ? VitalFault::kUnheard : VitalFault::kSilent;
}

VitalAnswer Vitals::look(Nanoseconds now) noexcept {
  VitalAnswer answer;
  for (std::size_t t = 0; t < tasks_.size(); ++t) {  // all of them: each look counts for their signs of life
    const VitalFault fault = judge(tasks_[t], seen_[t], now);
    if (fault != VitalFault::kNone && answer.is_healthy()) answer = {fault, TaskId(t), 0};
  }
  for (std::size_t s = 0; s < stacks_.size() && answer.is_healthy(); ++s)
    if (!stacks_[s].is_guard_whole()) answer = {VitalFault::kGuard, TaskId(), static_cast<std::uint32_t>(s)};
  return answer;
}

}  // namespace chimera::firmware
