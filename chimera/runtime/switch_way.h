// SPDX-License-Identifier: Apache-2.0
// Which way a switch goes, and why: fast, while the tasks cycle (switching.h), or slow, leaving tasks first
// (slow_switch.h). Asked once by whoever orders it.
#pragma once

#include <cstdint>
#include <span>

#include "chimera/base/setup_memory.h"
#include "chimera/runtime/constant_choice.h"
#include "chimera/runtime/rivals.h"
#include "chimera/runtime/switch_page.h"
#include "chimera/runtime/switch_schedule.h"

namespace chimera {

/// Plain value.
struct SwitchWay {
  std::uint8_t slow = 0;          ///< SlowReason; 0: fast
  ConstantUsers::Found constant;  ///< of kSlowForConstants: who stays ON, and what becomes another one for it
  PlanAnswer deadline;            ///< of kSlowForDeadlines: as SwitchSchedule::judge()
  TaskId absent;                  ///< of kSlowForResource: the first task of the plan that is NOT-CREATED
  TaskId rival;                   ///< and who has its resource; invalid: it waits for a constant of such a task
};

/// Why a fast switch that ended so is made the slow way next; 0: it is not. Context: any.
constexpr std::uint8_t reason_to_go_slowly(NoSwitch why) noexcept {
  return why == NoSwitch::kNoGap ? kSlowForGap : why == NoSwitch::kNotReady ? kSlowForDevice : 0;
}

/// Context of everything not marked: setup, or an edge of virtual time; no allocation.
class SwitchWays {
 public:
  /// The spec outlives this. Context: setup.
  void prepare(const ApplicationSpec& spec, SetupMemory& memory);
  /// The way of a plan that was made from `standing`, while the constants of sets[constants] are in force.
  SwitchWay judge(const SwitchPlan& plan, std::span<const TaskStanding> standing, std::uint32_t constants,
                  const MadeConstants& made) noexcept;

 private:
  const ApplicationSpec* spec_ = nullptr;
  Rivals rivals_;
  SwitchSchedule schedule_;
  ConstantUsers users_;
};

}  // namespace chimera
