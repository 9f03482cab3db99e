// SPDX-License-Identifier: Apache-2.0
// Conditions that delay a switch before a task may go ON (`safe_when`, an input without a value, other constants, a hot
// standby), and events that disturb a switch before it is committed.
#pragma once

#include <cstdint>
#include <span>

#include "chimera/runtime/job/job_threads.h"
#include "chimera/runtime/life/members.h"
#include "chimera/runtime/life/task_set.h"
#include "chimera/runtime/plan/idle_gap.h"
#include "chimera/runtime/plan/switch_agreement.h"
#include "chimera/runtime/plan/switch_plan.h"
#include "chimera/runtime/safe_condition.h"
#include "chimera/runtime/switch/switch_peers.h"

namespace chimera {

/// Extra wait after the deadline. The context whose turn it is aborts first, because only it knows the reason; the
/// others abort this time later.
inline constexpr Nanoseconds kAbortGrace = milliseconds(100);
/// A value that is waited for is read again after this time if no job ends before: no context rings for a value.
inline constexpr Nanoseconds kLookForValue = milliseconds(1);

/// True also if there is no condition. Context: cycle boundary; no allocation.
bool holds(TaskSet& set, const SafeCondition& asked) noexcept;

/// The first variable that the task, which is OFF, reads and that never had a value; invalid if there is none.
/// Variables of `handovers` do not count: an arriving task writes them. Context: cycle boundary; O(inputs).
VariableId missing_value(TaskSet& set, Task& task, std::span<const Handover> handovers) noexcept;

/// A task that arrives in a fast switch was initialised with other constants than those of the set after. Context:
/// cycle boundary; O(constants).
bool is_behind(TaskSet& set, const Task& task, const SwitchOrder& order) noexcept;
/// Re-initialises the task with those constants; false: that failed. Context: cycle boundary; as long as `reinit`
/// takes.
bool follow_constants(TaskSet& set, Task& task, const SwitchOrder& order, Nanoseconds now) noexcept;

/// Hot standbys of this context that arrive are turned OFF first, and armed as any task. False: a job of one of them is
/// under way. Context: cycle boundary; as long as `off` takes.
bool cool_down(TaskSet& set, JobThreads& threads, Members& members, const SwitchPlan& plan, Nanoseconds now) noexcept;

/// A switch with that order keeps the signal out: `on`, so that no variable gets two producers; `spawn` of a task that
/// cannot be created at the same time as one that the order names. Context: cycle boundary; O(tasks).
bool keeps_out(TaskSet& set, const SwitchOrder& order, std::span<const TaskId> tasks, Signal signal) noexcept;

/// State in which a switch took up its plan. Plain value.
struct UndisturbedState {
  TaskBits on;                ///< tasks that are ON
  std::uint16_t members = 0;  ///< contexts that take part
  bool flag_was_up = false;
  bool flag_was_raised = false;  ///< by a task of this context
};

/// Plain value.
struct Disturbance {
  NoSwitch why = NoSwitch::kNone;
  TaskId of;  ///< of kDisturbed and kFlagRaised, if it is known

  explicit operator bool() const noexcept { return why != NoSwitch::kNone; }
};

/// The first difference from what the plan was made from, in the context of `set`. Arriving tasks before place
/// `n_armed` of the plan are armed. Context: cycle boundary; O(tasks).
Disturbance find_disturbance(TaskSet& set, const SwitchPlan& plan, std::size_t n_armed,
                             const UndisturbedState& before, const SwitchPeers& peers) noexcept;

}  // namespace chimera
