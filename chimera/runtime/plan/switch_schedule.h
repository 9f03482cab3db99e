// SPDX-License-Identifier: Apache-2.0
// Checks whether the deadlines of an application hold over a switch of configurations: the analysis of transitions
// (schedule/transition.h) over the tasks of a specification, with their budgets as times.
#pragma once

#include <cstdint>
#include <span>

#include "chimera/base/setup_memory.h"
#include "chimera/runtime/application_spec.h"
#include "chimera/runtime/plan/switch_plan.h"
#include "chimera/schedule/transition.h"

namespace chimera {

/// A switch on one CPU. A task *must keep* its deadlines unless it has a server, `tolerate`, or `on_miss: abort`.
struct CpuTransition {
  std::uint32_t cpu = 0;
  bool is_moved = false;  ///< a task of this CPU arrives or leaves
  Guarantee guarantee = Guarantee::kYes;  ///< of those that must keep theirs; kNotStated: the others do
  TaskId task;            ///< of a guarantee that is not kYes: the first without one
  Nanoseconds takes;      ///< of kNo: a cycle of `task` at most; kNever: no bound was found
  Nanoseconds settled = kNever;  ///< TransitionVerdict::settled; kNever also where a task has no time
  bool was_promised = true;  ///< before the switch those that must keep theirs do

  /// Some task may miss a deadline that it must keep.
  bool is_lost() const noexcept { return guarantee == Guarantee::kNo || guarantee == Guarantee::kTooLong; }
};

/// Context of everything not marked: setup, or a cycle boundary of virtual time; milliseconds; no allocation.
class SwitchSchedule {
 public:
  /// Takes memory for `spec`, which outlives this. Context: setup.
  void prepare(const ApplicationSpec& spec, SetupMemory& memory);

  /// Considers the switch from the tasks that are ON by `statuses` to those of `after`; replaces the one considered
  /// before.
  void consider(std::span<const TaskStatus> statuses, const TaskBits& after) noexcept;
  /// The transition that was considered, on the CPU of that rtpu.
  CpuTransition on_cpu_of(RtpuId rtpu) noexcept;
  /// True if the rtpu is the first of its CPU: each CPU has one.
  bool is_first_of_cpu(RtpuId rtpu) const noexcept;

  /// kNotSchedulable, with the task and what its cycle may take, where a promise that holds before the switch would not
  /// hold over it; where nothing is promised before, nothing is lost. Budgets that are not stated count as nothing.
  PlanAnswer judge(std::span<const TaskStatus> statuses, const TaskBits& after) noexcept;

 private:
  void consider_hot(TaskId hot) noexcept;
  void analyse(std::span<const TransitionPart> parts, CpuTransition& found) noexcept;

  const ApplicationSpec* spec_ = nullptr;
  std::span<Work> works_;              // by task
  std::span<TransitionPart> parts_;    // by task
  std::span<TransitionPart> before_;   // by task: the set before as if all of it stayed
  std::span<WorkVerdict> verdicts_;    // by task
  std::span<MovingWork> room_;
  std::span<ProcessorUse> uses_;       // by rtpu
};

}  // namespace chimera
