// SPDX-License-Identifier: Apache-2.0
// What came between the plan of a switch and its commit: whoever takes part is to stay as the plan found it.
#pragma once

#include "chimera/runtime/switch_peers.h"
#include "chimera/runtime/switch_plan.h"
#include "chimera/runtime/task_set.h"

namespace chimera {

/// As a switch found it when its plan was taken up. Plain value.
struct UndisturbedState {
  std::uint16_t members = 0;  ///< contexts that take part
  bool flag_was_up = false;
  bool flag_was_raised = false;  ///< by somebody of this context
};

/// Plain value.
struct Disturbance {
  NoSwitch why = NoSwitch::kNone;
  TaskId of;  ///< of kDisturbed and kFlagRaised, where it is known

  explicit operator bool() const noexcept { return why != NoSwitch::kNone; }
};

/// The first one that is found in the context of `set`, whose arriving tasks before place `n_armed` of the plan are
/// armed. Context: cycle boundary; O(tasks of the plan).
Disturbance find_disturbance(TaskSet& set, const SwitchPlan& plan, std::size_t n_armed,
                             const UndisturbedState& before, const SwitchPeers& peers) noexcept;

}  // namespace chimera
