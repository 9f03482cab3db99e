// SPDX-License-Identifier: Apache-2.0
// The moves by which the contexts of an application agree on a switch: each is one compare-and-swap that names the
// number of its plan, so that whoever comes late with an older plan changes nothing.
//
//   announce   (any that is over)  -> PREPARED     by the one who plans
//   hand_on    run k -> run k + 1                  by the context of run k, when its tasks are armed
//   propose    PREPARED -> PROPOSED with T         by the context of the last run
//   agree      one bit of `missing` less; the last: PROPOSED -> COMMITTED
//   move_turn  step k -> step k + 1, of a slow switch, or backwards
//   commit     PREPARED -> COMMITTED               of a slow switch, by the context of the last step
//   abort      PREPARED or PROPOSED -> ABORTED     by any; never after COMMITTED
#pragma once

#include <optional>

#include "chimera/runtime/switch_page.h"

namespace chimera {

/// Context of everything: cycle boundary; lock-free; no allocation. A compare-and-swap is tried again only when another
/// context moved the word, which each does a bounded number of times for a plan.
class SwitchAgreement {
 public:
  /// `origin`: what instants count from. The page outlives this.
  SwitchAgreement(SwitchPage& page, Nanoseconds origin) noexcept : page_(&page), origin_(origin) {}

  PlanWord plan() const noexcept { return PlanWord::of(page_->plan.load(std::memory_order_acquire)); }
  /// The instant of the change. Requires: of a plan that was proposed.
  Nanoseconds at(const PlanWord& plan) const noexcept {
    return origin_ + microseconds(static_cast<std::int64_t>(plan.at_us));
  }
  /// The order of the plan that `plan` names; none when the words are not what announce() wrote, or name a context, a
  /// set or a task that does not exist.
  std::optional<SwitchOrder> order(const PlanWord& plan, std::size_t n_sets, std::size_t n_tasks) const noexcept;
  /// The run that is arming for that plan; none: the word is of another one.
  std::optional<std::uint16_t> run(std::uint16_t number) const noexcept;

  /// Requires: every context that lives is over with the plan before; one context, or the manager, plans.
  void announce(const SwitchOrder& order) noexcept;
  /// False: the plan is no longer in that run.
  bool hand_on(std::uint16_t number, std::uint16_t run) noexcept;
  /// Of a slow switch: so many steps are done, or left to be undone (TurnWord). False: it was not at `from`.
  bool move_turn(std::uint16_t number, std::uint16_t from, std::uint16_t to) noexcept;
  /// Every context has agreed, to the instant or that it takes part in a slow switch.
  bool have_all_agreed(std::uint16_t number) const noexcept;
  /// All steps of a slow switch are done: PREPARED -> COMMITTED, at once. Requires: `at` comes from round_up().
  bool commit(std::uint16_t number, Nanoseconds at) noexcept;
  /// The earliest instant that can be proposed at or after `instant`: whole microseconds. kNever: it is too far away.
  Nanoseconds round_up(Nanoseconds instant) const noexcept;
  /// Requires: `at` comes from round_up(). False: the plan is no longer PREPARED.
  bool propose(std::uint16_t number, Nanoseconds at) noexcept;
  /// The context uses no release from T on before it has seen what became of the plan. True: this commits it.
  bool agree(std::uint16_t number, std::uint32_t context) noexcept;
  /// False: it is committed, or of another number.
  bool abort(std::uint16_t number) noexcept;

 private:
  bool move(std::uint16_t number, SwitchPhase from, PlanWord to) noexcept;

  SwitchPage* page_;
  Nanoseconds origin_;
};

/// The number of the plan after `number`.
constexpr std::uint16_t next_plan(std::uint16_t number) noexcept {
  return number == UINT16_MAX ? std::uint16_t{1} : static_cast<std::uint16_t>(number + 1);
}

}  // namespace chimera
