// SPDX-License-Identifier: Apache-2.0
// The steps of a slow switch, in their order over all contexts: every context makes the same list from the order.
// runtime/switch/slow_switch.h carries them out.
//
//   check    could each user be initialised with the constants after the switch?       nothing has happened yet
//            the illegal-configuration flag goes up
//   off      of each leaving task, against the data flow
//   kill     of each rival of an arriving task (runtime/plan/rivals.h), in the opposite order of initialisation
//   spawn    of each arriving task that may be absent, in the order of initialisation
//   reinit   of each user whose constants have changed, in the order of initialisation
//   on       of each arriving task, producers first
//            the flag goes down
//
// kill and spawn are there where kSlowForResource says so; a task that is NOT-CREATED is not killed, and one that is
// there is not spawned. A step that fails is followed by all done before it backwards: off for on, reinit with the
// constants before (in the same order: producers first), kill for spawn, spawn for kill, on for off.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>

#include "chimera/runtime/plan/constant_choice.h"
#include "chimera/runtime/plan/rivals.h"
#include "chimera/runtime/plan/switch_agreement.h"
#include "chimera/runtime/plan/switch_plan.h"

namespace chimera {

enum class SlowAct : std::uint8_t { kCheck, kOff, kKill, kSpawn, kReinit, kOn };

struct SlowStep {
  SlowAct act = SlowAct::kCheck;
  TaskId task;
  constexpr bool operator==(const SlowStep&) const noexcept = default;
};

/// The steps of a slow switch, and whose turn it is at a turn word. Plain value. Context: cycle boundary; wait-free.
class SlowCourse {
 public:
  explicit SlowCourse(std::span<const SlowStep> steps = {}) noexcept;
  std::span<const SlowStep> steps() const noexcept { return steps_; }
  /// The first steps, which only check.
  std::size_t n_checks() const noexcept { return n_checks_; }
  /// The step that is undone next when `left` steps are left. A user of a constant is re-initialised after the producer
  /// of the constant, on the way back too.
  std::size_t undone_with(std::size_t left) const noexcept;
  /// The steps that are to be undone when `done` of them are done: all users are re-initialised if one was.
  std::size_t left_of(std::size_t done) const noexcept {
    return done > first_reinit_ && done < end_of_reinits_ ? end_of_reinits_ : done;
  }
  /// The step whose context moves the word on when it says `run` (TurnWord). None: each context ends by itself.
  std::optional<std::size_t> turn_at(std::uint16_t run) const noexcept;

 private:
  std::span<const SlowStep> steps_;
  std::size_t n_checks_ = 0;
  std::size_t first_reinit_ = 0, end_of_reinits_ = 0;
};

/// Holds the steps of one plan at a time.
class SlowPlanner {
 public:
  /// The spec outlives this. Context: setup.
  void prepare(const ApplicationSpec& spec, SetupMemory& memory);
  /// The steps of the plan: one and the same for equal arguments. `constants`, `slow`: as in SwitchOrder. Context:
  /// cycle boundary; O(tasks * ports * sets); no allocation.
  std::span<const SlowStep> plan(const SwitchPlan& plan, std::uint32_t constants, std::uint8_t slow) noexcept;

 private:
  void add(SlowAct act, std::span<const TaskId> tasks) noexcept;
  void add_resources(const SwitchPlan& plan) noexcept;

  const ApplicationSpec* spec_ = nullptr;
  Rivals rivals_;
  ConstantUsers users_;
  std::span<SlowStep> steps_;
  std::size_t n_ = 0;
};

/// How long the flag is up before anything else happens: so that each hardware task of `on` has acted on it. Context:
/// any; O(tasks).
Nanoseconds flag_lead(const ApplicationSpec& spec, const TaskBits& on) noexcept;

}  // namespace chimera
