// SPDX-License-Identifier: Apache-2.0
// A switch of configurations as data: which tasks arrive, leave and stay, and which variables get another producer.
// docs/formats/switch_plan.md says what each field means. A pure function makes the plan;
// runtime/switch/switching.h carries it out.
#pragma once

#include <algorithm>
#include <cstdint>
#include <span>

#include "chimera/base/setup_memory.h"
#include "chimera/runtime/application_spec.h"
#include "chimera/runtime/plan/rivals.h"
#include "chimera/runtime/plan/switch_agreement.h"
#include "chimera/runtime/task_status.h"
#include "chimera/task/state_machine.h"

namespace chimera {

/// Stands for "none of ApplicationSpec::sets".
inline constexpr std::uint32_t kNoSet = UINT32_MAX;

/// From the instant of the change on, every task of the new set reads `variable` from `to` instead of `from`.
struct Handover {
  VariableId variable;
  PortOf from;  ///< out-var of a leaving task; an invalid task: no task that is ON produced it before
  PortOf to;    ///< out-var of an arriving task
};

/// Why a switch is not made. Reasons of the first group are found before anything is done; others abort the switch.
enum class NoSwitch : std::uint8_t {
  kNone,
  kUnknownSet,   ///< the target is none of the sets
  kNothingToDo,  ///< exactly the tasks of the target are ON
  kInError,      ///< `task`, of the target, is in ERROR: to be cleared first
  kNotCreated,   ///< `task`, of the target, is NOT-CREATED and not only for a rival, or its `init` or `kill` runs
  kKeptOff,      ///< a task or reaction asked, and an operator has turned `task`, of the target, OFF
  kUnderWay,     ///< another switch is under way
  kNotSchedulable,  ///< `task` might miss a deadline if leaving and arriving tasks met: it is slow for that

  kOnFailed,      ///< `on` of `task` failed
  kStepTooLarge,  ///< of `variable`, which `task` would produce
  kNoGap,         ///< the processor was never idle for as long as `on` of `task` takes
  kNoValue,       ///< `variable`, which `task` reads, never had one
  kNotSafe,       ///< `variable` did not hold what NamedSet::safe_when asks
  kDisturbed,     ///< a signal, an error or its own end moved `task`, which takes part, to another state
  kFlagRaised,    ///< a task or an operator raised the illegal-configuration flag
  kRunEnded,      ///< the run ended before the instant of the change
  kLate,          ///< an rtpu came to the instant of the change before all had agreed to it
  kMemberDied,    ///< an rtpu that takes part died
  kDamaged,       ///< the order on the shared page is not what was written, or does not fit the application
  kCancelled,     ///< the requester took the request back
  kBadConstant,   ///< `task` cannot be initialised with the constants after it
  kStepFailed,    ///< a method of `task` failed, in a slow switch
  kNotReady,      ///< `task` was not ready within the deadline, in a slow switch; in a fast one not at once
  kNoAnswer,      ///< an rtpu did not finish its turn by the deadline, and gave no reason
};

/// True if the reason is the delay of another context, which may know the cause. Context: any.
constexpr bool is_of_another(NoSwitch why) noexcept { return why == NoSwitch::kLate || why == NoSwitch::kNoAnswer; }

/// Answer to a request for a plan: the plan was made, or the reason why not.
struct PlanAnswer {
  NoSwitch why = NoSwitch::kNone;
  TaskId task;  ///< of kInError, kNotCreated, kKeptOff: the first by data flow; of kNotSchedulable: one that might miss
  Nanoseconds takes = kNever;  ///< of kNotSchedulable: a cycle of `task` at most; kNever: no bound was found

  explicit operator bool() const noexcept { return why == NoSwitch::kNone; }
};

/// Lists point into the SwitchPlanner that made the plan, or are constant.
struct SwitchPlan {
  std::uint32_t number = 0;
  std::uint32_t before = kNoSet;       ///< in ApplicationSpec::sets; kNoSet: the ON tasks are none of them
  std::uint32_t after = kNoSet;        ///< in ApplicationSpec::sets; kNoSet: the target is none of them
  std::span<const TaskId> arriving;    ///< in data-flow order, producers first
  std::span<const TaskId> leaving;     ///< against the data flow
  std::span<const TaskId> staying;     ///< in data-flow order
  std::span<const Handover> handovers; ///< in the order of ApplicationSpec::variables
  const PlanAnswer* deadline = nullptr;  ///< of SwitchSchedule::judge(), before the run; null: to be asked
};

/// Places [begin, end) in SwitchPlan::arriving: a longest row of tasks that belong to one rtpu.
struct SwitchRun {
  std::size_t begin = 0, end = 0;
};

/// The run of that number; begin == end behind the last one. Context: cycle boundary; O(tasks).
SwitchRun find_run(const SwitchPlan& plan, std::span<const TaskSpec> tasks, std::uint16_t number) noexcept;

/// How long before the instant of the change it is proposed. Every context agrees between two jobs, so this is longer
/// than `longest_job`, the longest cycle measured so far; else at most 1 ms, and three quarters of the period of the
/// fastest task that arrives or leaves. Context: any; O(tasks).
Nanoseconds lead_of(const SwitchPlan& plan, std::span<const TaskSpec> tasks, Nanoseconds longest_job) noexcept;

/// Returns the tasks that are ON. Context: cycle boundary.
TaskBits tasks_on(std::span<const TaskStatus> statuses) noexcept;
/// The tasks of the set of that number. Requires: it is one of them. Context: cycle boundary.
TaskBits tasks_of(const ApplicationSpec& spec, std::uint32_t set) noexcept;
/// The tasks that are ON after the plan. Context: cycle boundary.
TaskBits target_of(const SwitchPlan& plan) noexcept;
/// Number of the set that has exactly these tasks; kNoSet: none. Context: cycle boundary; O(sets * tasks).
std::uint32_t set_of(const ApplicationSpec& spec, const TaskBits& tasks) noexcept;
/// Number of the set that is ON, where `is_on(TaskId)` says which tasks are. First choice: a set with exactly these
/// tasks. Second choice: a set of as many tasks, each ON or replaced by an ON task that stands in for it. kNoSet:
/// none. Context: cycle boundary; O(sets * tasks^2).
template <class IsOn>
std::uint32_t set_in_force(const ApplicationSpec& spec, IsOn is_on) noexcept {
  std::size_t n_on = 0;
  for (std::size_t t = 0; t < spec.tasks.size(); ++t) n_on += is_on(TaskId(t)) ? 1 : 0;
  const auto is_stood_in = [&](TaskId task) {
    for (const StandbySpec& each : spec.standbys)
      for (const TaskId by : {each.standby, each.primary})
        if (spec.stand_in(task, by) && is_on(by)) return true;
    return false;
  };
  std::uint32_t found = kNoSet;
  for (std::uint32_t s = 0; s < spec.sets.size(); ++s) {
    const std::span<const TaskId> order = spec.sets[s].order;
    if (order.size() != n_on) continue;
    if (std::all_of(order.begin(), order.end(), is_on)) return s;
    const auto is_there = [&](TaskId task) { return is_on(task) || is_stood_in(task); };
    if (found == kNoSet && std::all_of(order.begin(), order.end(), is_there)) found = s;
  }
  return found;
}
/// Condition that must hold before a switch to the set; empty for kNoSet. Context: cycle boundary.
const SafeCondition& asked_of(const ApplicationSpec& spec, std::uint32_t set) noexcept;

/// Holds the lists of one plan at a time.
class SwitchPlanner {
 public:
  /// Takes memory for any plan of this spec, which outlives the planner. Context: setup.
  void prepare(const ApplicationSpec& spec, SetupMemory& memory);

  /// The plan that turns the ON set into sets[target]. Equal arguments give equal plans. `statuses[t]` belongs to task
  /// t. Writes `plan` only if there is one, and leaves its number as it was. Replaces the lists of the plan before.
  /// Context: cycle boundary; O(tasks + links); no allocation.
  PlanAnswer plan(std::uint32_t target, std::span<const TaskStatus> statuses, SwitchPlan& plan) noexcept;
  /// Plans a switch to any set of tasks. If they are one of the sets, the result is the plan above.
  PlanAnswer plan(const TaskBits& target, std::span<const TaskStatus> statuses, SwitchPlan& plan) noexcept;

  /// Calls the free function of this name. Context: cycle boundary.
  std::uint32_t set_in_force(std::span<const TaskStatus> statuses) const noexcept {
    return chimera::set_in_force(*spec_, [&](TaskId task) { return statuses[task.index].state == State::kOn; });
  }

 private:
  const SwitchPlan* made_plan(std::uint32_t target, std::span<const TaskStatus> statuses) const noexcept;
  PlanAnswer plan_for(std::span<const TaskId> order, std::span<const TaskStatus> statuses, SwitchPlan& plan) noexcept;
  bool is_in_target(TaskId task) const noexcept { return in_target_[task.index]; }
  std::span<const Handover> list_handovers(std::span<const TaskStatus> statuses) noexcept;

  const ApplicationSpec* spec_ = nullptr;
  Rivals rivals_;
  std::span<bool> in_target_;  // by task
  std::span<TaskId> arriving_, leaving_, staying_;
  std::span<TaskId> target_;  // of a set without a name, in data-flow order
  std::span<Handover> handovers_;  // one for each variable
};

}  // namespace chimera
