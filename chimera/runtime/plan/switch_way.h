// SPDX-License-Identifier: Apache-2.0
// Chooses the way of a switch, with the reason: fast, while the tasks cycle (switching.h), or slow, leaving tasks first
// (slow_switch.h). The process that orders the switch asks once.
#pragma once

#include <algorithm>
#include <cstdint>
#include <span>

#include "chimera/base/mechanisms.h"
#include "chimera/base/part_if.h"
#include "chimera/base/setup_memory.h"
#include "chimera/runtime/plan/constant_choice.h"
#include "chimera/runtime/plan/idle_gap.h"
#include "chimera/runtime/plan/rivals.h"
#include "chimera/runtime/plan/switch_agreement.h"
#include "chimera/runtime/plan/switch_schedule.h"

namespace chimera {

/// Plain value.
struct SwitchWay {
  std::uint8_t slow = 0;          ///< SlowReason; 0: fast
  ConstantUsers::Found constant;  ///< of kSlowForConstants: a task that stays ON, and the constant that changes for it
  PlanAnswer deadline;            ///< of kSlowForDeadlines: as SwitchSchedule::judge()
  TaskId gapless;                 ///< of kSlowForGap: its `on` fits no gap; invalid: none was found by the deadline
  Nanoseconds needed;             ///< the gap that `gapless` needs
  TaskId absent;                  ///< of kSlowForResource: the first task of the plan that is NOT-CREATED
  TaskId rival;                   ///< the task that has its resource; invalid: `absent` lacks a constant of such a task
};

/// Reason to retry a failed fast switch the slow way; 0: it is not retried so. Context: any.
constexpr std::uint8_t reason_to_go_slowly(NoSwitch why) noexcept {
  return why == NoSwitch::kNoGap ? kSlowForGap : why == NoSwitch::kNotReady ? kSlowForDevice : 0;
}

/// SwitchOrder::lead of that try, from the lead of the first. The lead contains the longest job already. Only other
/// delays of a context get more time, eight times as much with each try. Context: any.
constexpr Nanoseconds lead_of_try(Nanoseconds first, std::uint32_t tries) noexcept {
  constexpr std::int64_t kMoreTime = 8;
  if (tries <= 1) return first;
  Nanoseconds more = std::min(first, milliseconds(1));
  for (std::uint32_t i = 1; i < tries; ++i) more = more * kMoreTime;
  return first + more;
}

/// Context of everything not marked: setup, or a cycle boundary of virtual time; no allocation.
class SwitchWays {
 public:
  /// The spec outlives this. Context: setup.
  void prepare(const ApplicationSpec& spec, SetupMemory& memory);
  /// The way of a plan that was made from `statuses`, while the constants of sets[constants] are in force.
  SwitchWay judge(const SwitchPlan& plan, std::span<const TaskStatus> statuses, std::uint32_t constants,
                  const MadeConstants& made, const NeededGaps& gaps) noexcept;

 private:
  void find_gapless(const SwitchPlan& plan, std::span<const TaskStatus> statuses, const NeededGaps& gaps,
                    SwitchWay& way) const noexcept;

  const ApplicationSpec* spec_ = nullptr;
  Rivals rivals_;
  [[no_unique_address]] PartIf<mechanisms::kTransitions, SwitchSchedule> schedule_;
  ConstantUsers users_;
};

}  // namespace chimera
