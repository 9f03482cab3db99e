// SPDX-License-Identifier: Apache-2.0
// The words on which the contexts of an application agree when they switch configurations together, the order that says
// what is to be switched, and the moves of the words. The words are plain shared memory that all contexts may write; a
// context that is alone has a page of its own. docs/formats/processes.md,
// docs/decisions/0045-a-switch-is-committed-by-the-rtpus.md.
//
// Each move is one compare-and-swap that names the number of its plan, so that a late move of an older plan changes
// nothing.
//
//   announce   (any that is over)  -> PREPARED     by the context, or the manager, that plans
//   hand_on    run k -> run k + 1                  by the context of run k, when its tasks are armed
//   propose    PREPARED -> PROPOSED with T         by the context of the last run
//   agree      clears one bit of `missing`; the last: PROPOSED -> COMMITTED
//   move_turn  step k -> step k + 1, of a slow switch, or backwards
//   commit     PREPARED -> COMMITTED               of a slow switch, by the context of the last step
//   abort      PREPARED or PROPOSED -> ABORTED     by any; never after COMMITTED
//   restore    overwritten words -> ABORTED, or COMMITTED as before, by the manager
#pragma once

#include <array>
#include <atomic>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>

#include "chimera/base/ids.h"
#include "chimera/base/mechanisms.h"
#include "chimera/base/time.h"

namespace chimera {

inline constexpr std::uint32_t kMaxContexts = 16;        // bits in TurnWord::missing
/// The largest number of tasks of an application that can be switched; an image has less room.
inline constexpr std::size_t kMostTasksOfImage = 64, kMaxSwitchedTasks = mechanisms::kPeers ? 256 : kMostTasksOfImage;

/// A set of tasks, as bits. Plain value.
struct TaskBits {
  std::array<std::uint64_t, kMaxSwitchedTasks / 64> words{};

  constexpr bool has(TaskId task) const noexcept { return (words[task.index / 64] >> task.index % 64 & 1u) != 0; }
  constexpr void add(TaskId task) noexcept { words[task.index / 64] |= std::uint64_t{1} << task.index % 64; }
  constexpr void remove(TaskId task) noexcept { words[task.index / 64] &= ~(std::uint64_t{1} << task.index % 64); }
  constexpr bool operator==(const TaskBits&) const noexcept = default;
};

/// Context: any; wait-free.
constexpr TaskBits bits_of(std::span<const TaskId> tasks) noexcept {
  TaskBits bits;
  for (const TaskId id : tasks) bits.add(id);
  return bits;
}

/// No bit stands for a task that the application does not have. Context: any; wait-free.
constexpr bool names_only(const TaskBits& bits, std::size_t n_tasks) noexcept {
  for (std::size_t t = n_tasks; t < kMaxSwitchedTasks; ++t)
    if (bits.has(TaskId(t))) return false;
  return true;
}

/// How far a plan has come. A page of zeros says that plan 0 was aborted.
enum class SwitchPhase : std::uint8_t { kAborted, kPrepared, kProposed, kCommitted };

/// SwitchPage::plan: bits 0-15 number, 16-17 phase, 18-63 the instant of the change in microseconds since the origin of
/// the grid of releases (2.2 years of them).
struct PlanWord {
  std::uint16_t number = 0;
  SwitchPhase phase = SwitchPhase::kAborted;
  std::uint64_t at_us = 0;  ///< of kProposed and kCommitted

  static constexpr std::uint64_t kLatest = (std::uint64_t{1} << 46) - 1;
  constexpr bool is_open() const noexcept { return phase == SwitchPhase::kPrepared || phase == SwitchPhase::kProposed; }
  constexpr std::uint64_t word() const noexcept {
    return at_us << 18 | static_cast<std::uint64_t>(phase) << 16 | number;
  }
  static constexpr PlanWord of(std::uint64_t word) noexcept {
    return {static_cast<std::uint16_t>(word), static_cast<SwitchPhase>(word >> 16 & 3u), word >> 18};
  }
};

/// SwitchPage::turn: bits 0-15 number of the plan, 16-31 the run that is arming, 32-47 contexts that have not agreed.
/// In a slow switch the run is the number of steps that are done; with kBack, of steps that are left to be undone.
struct TurnWord {
  static constexpr std::uint16_t kBack = 0x8000;
  std::uint16_t number = 0;
  std::uint16_t run = 0;
  std::uint16_t missing = 0;  ///< bit c: context c

  constexpr std::uint64_t word() const noexcept {
    return std::uint64_t{missing} << 32 | std::uint64_t{run} << 16 | number;
  }
  static constexpr TurnWord of(std::uint64_t word) noexcept {
    return {static_cast<std::uint16_t>(word), static_cast<std::uint16_t>(word >> 16),
            static_cast<std::uint16_t>(word >> 32)};
  }
};

/// Why a switch is slow: bits. docs/decisions/0061-a-slow-switch.md.
enum SlowReason : std::uint8_t {
  kSlowForConstants = 1,  ///< a task that stays ON is initialised with a constant that becomes another one
  kSlowForGap = 2,        ///< `on` of an arriving task fits no gap
  kSlowForDeadlines = 4,  ///< a task might miss a deadline if leaving and arriving tasks met
  kSlowForResource = 8,   ///< an arriving task is NOT-CREATED, because another one has its resource
  kSlowForDevice = 16,    ///< `on` of an arriving task answered not yet
};
inline constexpr std::uint8_t kSlowReasons = 31;

/// Describes a switch. From it, and from the application, every context makes one and the same SwitchPlan.
struct SwitchOrder {
  std::uint16_t number = 0;   ///< never 0; another one than that of the order before
  std::uint16_t members = 0;  ///< bit c: context c lives and takes part
  std::uint32_t after = 0;    ///< the set that is to be ON, in ApplicationSpec::sets; UINT32_MAX: it is none of them
  Nanoseconds until;          ///< a plan that is not committed at this instant is aborted
  Nanoseconds lead;           ///< from the proposal to the instant of the change, at least
  TaskBits on;                ///< the tasks that are ON
  TaskBits target;            ///< the tasks that are to be ON
  std::uint8_t slow = 0;      ///< SlowReason: leaving tasks go OFF first, under the flag; 0: it is fast
  std::uint32_t constants = UINT32_MAX;  ///< the set whose constants are in force until then; UINT32_MAX: of none
  /// The set whose constants are in force then: tasks that are no configuration keep those that they have.
  constexpr std::uint32_t constants_after() const noexcept { return after == UINT32_MAX ? constants : after; }
  constexpr bool operator==(const SwitchOrder&) const noexcept = default;
};

/// Every word is changed as a whole. `order` is written before `plan` names its number, and not again before all living
/// contexts are done with it; relaxed, published by `plan`. Only compare-and-swap changes `plan` and `turn`
/// (switch_agreement.h): release, which pairs with the acquire of each load.
struct SwitchPage {
  static constexpr std::size_t kOrderWords = 4 + 2 * (kMaxSwitchedTasks / 64);
  alignas(64) std::atomic<std::uint64_t> plan{0};
  alignas(64) std::atomic<std::uint64_t> turn{0};
  alignas(64) std::atomic<std::uint64_t> order[kOrderWords + 1];  // the last: a sum over the others
};

/// Progress of one context. Only its owner writes it: release, after everything that the word reports.
struct SwitchProgress {
  std::atomic<std::uint32_t> adopted{0};  ///< number of the last plan whose bindings its jobs use, or that was aborted
  std::atomic<std::uint32_t> over{0};     ///< number of the last plan of which nothing is left to do there
};

/// Context of everything: cycle boundary; lock-free; no allocation. A compare-and-swap is tried again only when another
/// context moved the word, which each does a bounded number of times for a plan.
class SwitchAgreement {
 public:
  /// Instants count from `origin`. The page outlives this.
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
  void announce(const SwitchOrder& order) noexcept { write(order, {order.number, SwitchPhase::kPrepared, 0}, 0); }
  /// True if something has overwritten the words of that plan. Requires: it was announced last.
  bool is_overwritten(std::uint16_t number) const noexcept {
    const PlanWord now = plan();
    return now.number != number || (now.phase != SwitchPhase::kCommitted && !run(number));
  }
  /// Writes all words anew. `plan` is that of the order, aborted or committed; `run` goes into the turn word. Requires:
  /// is_overwritten().
  void restore(const SwitchOrder& order, const PlanWord& plan, std::uint16_t run) noexcept { write(order, plan, run); }
  /// False: the plan is no longer in that run.
  bool hand_on(std::uint16_t number, std::uint16_t run) noexcept;
  /// Slow switch: sets the number of steps done, or left to be undone (TurnWord). False: the turn was not at `from`.
  bool move_turn(std::uint16_t number, std::uint16_t from, std::uint16_t to) noexcept;
  /// True if every context has agreed: to the instant, or to take part in a slow switch.
  bool have_all_agreed(std::uint16_t number) const noexcept;
  /// All steps of a slow switch are done: PREPARED -> COMMITTED, at once. Requires: `at` comes from round_up().
  bool commit(std::uint16_t number, Nanoseconds at) noexcept;
  /// The earliest instant that can be proposed at or after `instant`: whole microseconds. kNever: it is too far away.
  Nanoseconds round_up(Nanoseconds instant) const noexcept;
  /// Requires: `at` comes from round_up(). False: the plan is no longer PREPARED.
  bool propose(std::uint16_t number, Nanoseconds at) noexcept;
  /// The context uses no release from T on before it has seen the end of the plan. True: this commits the plan.
  bool agree(std::uint16_t number, std::uint32_t context) noexcept;
  /// False: the plan is committed, or has another number.
  bool abort(std::uint16_t number) noexcept;

 private:
  void write(const SwitchOrder& order, const PlanWord& plan, std::uint16_t run) noexcept;
  bool move(std::uint16_t number, SwitchPhase from, PlanWord to) noexcept;

  SwitchPage* page_;
  Nanoseconds origin_;
};

/// The number of the plan after `number`.
constexpr std::uint16_t next_plan(std::uint16_t number) noexcept {
  return number == UINT16_MAX ? std::uint16_t{1} : static_cast<std::uint16_t>(number + 1);
}

}  // namespace chimera
