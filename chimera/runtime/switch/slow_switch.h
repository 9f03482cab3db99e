// SPDX-License-Identifier: Apache-2.0
// Carries out the part of one context in a slow switch. The context takes its steps (slow_plan.h) at its turn, under
// the illegal-configuration flag. If a step of any context failed, it takes them back. The turn word on the page says
// whose turn it is, so no manager is needed until all is over. Steps of a context that died are left out.
// docs/decisions/0061-a-slow-switch.md.
#pragma once

#include <cstdint>
#include <span>

#include "chimera/runtime/plan/switch_agreement.h"
#include "chimera/runtime/switch/slow_steps.h"
#include "chimera/runtime/switch/switch_peers.h"
#include "chimera/runtime/switch/switch_record.h"

namespace chimera {

/// Context of everything not marked: cycle boundary; as long as the methods of components take; no allocation but
/// theirs.
class SlowSwitch {
 public:
  using Parts = SlowSteps::Parts;
  /// All parts outlive this.
  explicit SlowSwitch(const Parts& parts) noexcept : parts_(parts), here_(parts) {}
  /// Context: setup.
  void prepare();

  /// The plan, whose lists stay as they are, by the order; says on the page that this context, number `me`, takes part.
  void begin(SwitchAgreement agreement, const SwitchPlan& plan, const SwitchOrder& order, SwitchPeers& peers,
             std::uint32_t me) noexcept;
  /// Goes on. True: nothing is left to do here, and end() says how the switch ended.
  bool step(SwitchAgreement agreement, Nanoseconds now) noexcept;
  SwitchEnd end() const noexcept { return end_; }
  /// When to call step() although no bell rings and no job ends.
  Nanoseconds wake() const noexcept { return wake_; }
  /// Aborts the switch on the page, unless it is committed. Later steps undo what is done here.
  void abort(SwitchAgreement agreement, NoSwitch why, TaskId of, VariableId variable) noexcept;
  /// The run is over: nothing more is done, and the flag is no longer held.
  void cut(SwitchAgreement agreement) noexcept;

 private:
  bool is_mine(std::size_t step) const noexcept { return parts_.set.is_mine(steps_[step].task); }
  bool is_of_dead(std::size_t step) const noexcept;
  bool turns_round(std::size_t done) const noexcept;
  bool may_go_on(SwitchAgreement agreement, std::size_t done, Nanoseconds now) noexcept;
  TaskId find_disturbed(std::size_t done) const noexcept;
  bool is_as_left(const Task& task, std::size_t done) const noexcept;
  void hold_flag(Nanoseconds now) noexcept;
  void conclude(SwitchEnd end, Nanoseconds now) noexcept;
  StepEnd carry_out(SwitchAgreement agreement, const SlowStep& step, Nanoseconds now) noexcept;

  Parts parts_;
  SlowPlanner planner_;
  SlowSteps here_;
  SwitchPeers* peers_ = nullptr;
  const SwitchPlan* plan_ = nullptr;
  SwitchOrder order_;
  std::span<const SlowStep> steps_;
  SlowCourse course_;
  Nanoseconds wake_ = kNever;
  Nanoseconds held_since_ = kNever;  // the flag, by this context
  SwitchEnd end_ = SwitchEnd::kAborted;
  bool was_raised_ = false;  // the flag, in this context, when the switch began
  bool is_safe_ = false;     // `safe_when` held
};

}  // namespace chimera
