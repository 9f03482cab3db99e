// SPDX-License-Identifier: Apache-2.0
// A slow switch as one context carries out its part: its steps (slow_plan.h) when it is their turn, under the
// illegal-configuration flag, and backwards when one of them failed, whoever's. Whose turn it is says the turn word on
// the page, so that no manager is needed until all is over; the steps of a context that died are left out.
// docs/decisions/0061-a-slow-switch.md.
#pragma once

#include <cstdint>
#include <span>

#include "chimera/runtime/context_tap.h"
#include "chimera/runtime/creation_steps.h"
#include "chimera/runtime/idle_gap.h"
#include "chimera/runtime/settlement.h"
#include "chimera/runtime/slow_plan.h"
#include "chimera/runtime/switch_agreement.h"
#include "chimera/runtime/switch_peers.h"
#include "chimera/runtime/switch_record.h"

namespace chimera {

/// Context of everything not marked: cycle boundary; as long as the methods of components take; no allocation but
/// theirs.
class SlowSwitch {
 public:
  /// All of it outlives this.
  struct Parts {
    TaskSet& set;
    JobThreads& threads;
    Settlement& settlement;
    ContextTap& tap;
    JobClock& clock;
    IdleGap& gap;
    SwitchRecord& record;
  };
  explicit SlowSwitch(const Parts& parts) noexcept : parts_(parts) {}
  /// Context: setup.
  void prepare();

  /// The plan, whose lists stay as they are, by the order; says on the page that this context, number `me`, takes part.
  void begin(SwitchAgreement agreement, const SwitchPlan& plan, const SwitchOrder& order, SwitchPeers& peers,
             std::uint32_t me) noexcept;
  /// Goes on. True: nothing is left to do here; end() says what became of it.
  bool step(SwitchAgreement agreement, Nanoseconds now) noexcept;
  SwitchEnd end() const noexcept { return end_; }
  /// When a step is worth while although nobody rings and no job ends.
  Nanoseconds wake() const noexcept { return wake_; }
  /// Aborts it on the page, unless it is committed; what is done here is undone by steps.
  void abort(SwitchAgreement agreement, NoSwitch why, TaskId of, VariableId variable) noexcept;
  /// The run is over: nothing more is done, and the flag is no longer held.
  void cut(SwitchAgreement agreement) noexcept;

 private:
  std::size_t undone_with(std::size_t left) const noexcept;
  bool is_mine(std::size_t step) const noexcept { return parts_.set.is_mine(steps_[step].task); }
  bool is_of_dead(std::size_t step) const noexcept;
  bool turns_round(std::size_t done) const noexcept;
  bool may_go_on(SwitchAgreement agreement, std::size_t done, Nanoseconds now) noexcept;
  TaskId find_disturbed(std::size_t done) const noexcept;
  bool is_as_left(const Task& task, std::size_t done) const noexcept;
  bool leave(std::size_t done, std::size_t& left, Nanoseconds now) noexcept;
  void hold_flag(Nanoseconds now) noexcept;
  void conclude(SwitchEnd end, Nanoseconds now) noexcept;
  StepEnd carry_out(SwitchAgreement agreement, const SlowStep& step, Nanoseconds now) noexcept;
  StepEnd check(SwitchAgreement agreement, const Task& task) noexcept;
  StepEnd turn_off(SwitchAgreement agreement, Task& task, Nanoseconds now) noexcept;
  StepEnd create(SwitchAgreement agreement, Task& task, Signal signal, Nanoseconds now) noexcept;
  StepEnd turn_on(SwitchAgreement agreement, Task& task, Nanoseconds now) noexcept;
  StepEnd reinit(SwitchAgreement agreement, Task& task, Nanoseconds now) noexcept;
  StepEnd fail(SwitchAgreement agreement, NoSwitch why, const Task& task) noexcept;
  StepEnd wait_a_cycle(const Task& task, Nanoseconds now) noexcept;
  StepEnd turn_on_again(Task& task, Nanoseconds now) noexcept;
  StepEnd undo(const SlowStep& step, Nanoseconds now) noexcept;
  SignalReport move(Task& task, Signal signal, Nanoseconds now) noexcept;
  bool waits_for_idle(Nanoseconds now) noexcept;
  bool waits_for_gap(const Task& task, Method method, Nanoseconds now) noexcept;
  Task& task(TaskId id) noexcept { return parts_.set.tasks()[id.index]; }

  Parts parts_;
  SlowPlanner planner_;
  CreationSteps created_;
  SwitchPeers* peers_ = nullptr;
  const SwitchPlan* plan_ = nullptr;
  SwitchOrder order_;
  std::span<const SlowStep> steps_;
  std::size_t n_checks_ = 0;
  std::size_t first_reinit_ = 0, end_of_reinits_ = 0;  // in steps_
  Nanoseconds wake_ = kNever;
  Nanoseconds held_since_ = kNever;  // the flag, by this context
  Nanoseconds waits_since_ = kNever; // for a gap
  Nanoseconds back_until_ = kNever;  // for a device on the way back
  SwitchEnd end_ = SwitchEnd::kAborted;
  bool was_raised_ = false;  // the flag, by somebody of this context, when it began
  bool was_idle_ = false;    // the processor, since who leaves is OFF
  bool is_safe_ = false;     // what `safe_when` asks held
};

}  // namespace chimera
