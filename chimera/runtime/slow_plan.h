// SPDX-License-Identifier: Apache-2.0
// The steps of a slow switch, in their order over all contexts: every context makes the same list from the order. Who
// carries them out is runtime/slow_switch.h.
//
//   check    could each user be initialised with the constants after the switch?       nothing has happened yet
//            the illegal-configuration flag goes up
//   off      of each leaving task, against the data flow
//   reinit   of each user whose constants are others by now, in the order of initialisation
//   on       of each arriving task, producers first
//            the flag goes down
//
// A step that fails is followed by all done before it backwards: off for on, reinit with the constants before (in the
// same order: producers first), on for off.
#pragma once

#include <cstdint>
#include <span>

#include "chimera/runtime/constant_choice.h"
#include "chimera/runtime/switch_page.h"
#include "chimera/runtime/switch_plan.h"

namespace chimera {

enum class SlowAct : std::uint8_t { kCheck, kOff, kReinit, kOn };

struct SlowStep {
  SlowAct act = SlowAct::kCheck;
  TaskId task;
  constexpr bool operator==(const SlowStep&) const noexcept = default;
};

/// Holds the steps of one plan at a time.
class SlowPlanner {
 public:
  /// The spec outlives this. Context: setup.
  void prepare(const ApplicationSpec& spec, SetupMemory& memory);
  /// The steps of the plan: one and the same for equal arguments. `constants`: as SwitchOrder::constants. Context:
  /// cycle boundary; O(tasks * ports * sets); no allocation.
  std::span<const SlowStep> plan(const SwitchPlan& plan, std::uint32_t constants) noexcept;

 private:
  ConstantUsers users_;
  std::span<SlowStep> steps_;
};

/// How long the flag is up before anything else happens: so that each hardware task of `on` has acted on it. Context:
/// any; O(tasks).
Nanoseconds flag_lead(const ApplicationSpec& spec, const TaskBits& on) noexcept;

}  // namespace chimera
