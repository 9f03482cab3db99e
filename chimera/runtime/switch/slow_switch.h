// SPDX-License-Identifier: Apache-2.0
// A slow switch as one context carries out its part: its steps (slow_plan.h) when it is their turn, under the
// illegal-configuration flag, and backwards when one of them failed, whoever's. Whose turn it is says the turn word on
// the page, so that no manager is needed until all is over; the steps of a context that died are left out.
// docs/decisions/0061-a-slow-switch.md.
#pragma once

#include <cstdint>
#include <span>

#include "chimera/runtime/switch/slow_steps.h"
#include "chimera/runtime/switch/switch_agreement.h"
#include "chimera/runtime/switch/switch_peers.h"
#include "chimera/runtime/switch/switch_record.h"

namespace chimera {

/// Context of everything not marked: cycle boundary; as long as the methods of components take; no allocation but
/// theirs.
class SlowSwitch {
 public:
  using Parts = SlowSteps::Parts;
  /// All of it outlives this.
  explicit SlowSwitch(const Parts& parts) noexcept : parts_(parts), here_(parts) {}
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

  Parts parts_;
  SlowPlanner planner_;
  SlowSteps here_;
  SwitchPeers* peers_ = nullptr;
  const SwitchPlan* plan_ = nullptr;
  SwitchOrder order_;
  std::span<const SlowStep> steps_;
  std::size_t n_checks_ = 0;
  std::size_t first_reinit_ = 0, end_of_reinits_ = 0;  // in steps_
  Nanoseconds wake_ = kNever;
  Nanoseconds held_since_ = kNever;  // the flag, by this context
  SwitchEnd end_ = SwitchEnd::kAborted;
  bool was_raised_ = false;  // the flag, by somebody of this context, when it began
  bool is_safe_ = false;     // what `safe_when` asks held
};

}  // namespace chimera
