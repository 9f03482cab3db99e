// SPDX-License-Identifier: Apache-2.0
// A switch among the configurations of one context, while its tasks cycle. All or nothing, in this order:
//
//   ask      the plan is made                                         refused: nothing was begun
//   arm      `on` of each arriving task, producers first, beside its predecessor: it reads what it will read, takes
//            over the outputs that stand, writes into its own group   fails: `off` of those armed; nobody else saw it
//   commit   at one instant T, between two jobs: arriving tasks are ON, leaving ones are OFF, readers read the new ones
//   after    `off` of each leaving task, against the data flow; the first cycles are looked at for the receipt
//
// `on` and `off` run while the processor is idle, in a gap before the next release that is as long as the method took
// before. T is the end of the last arming or, when that overran its gap, the next instant at which no released job
// waits: so every job released before T has ended with the bindings of its release.
// docs/decisions/0049-switch-in-one-context.md.
#pragma once

#include <cstdint>
#include <span>

#include "chimera/runtime/context_tap.h"
#include "chimera/runtime/members.h"
#include "chimera/runtime/settlement.h"
#include "chimera/runtime/switch_plan.h"
#include "chimera/runtime/switch_receipt.h"
#include "chimera/runtime/task_set.h"
#include "chimera/schedule/ready_queue.h"

namespace chimera {

/// For executors whose jobs run in the thread that takes the edges. Context of everything not marked: cycle boundary;
/// as long as the methods of components take; no allocation but theirs.
class Switching {
 public:
  /// What a switch works on; all of it outlives this.
  struct Parts {
    TaskSet& set;
    ReadyQueue& queue;
    Members& members;
    Settlement& settlement;
    ContextTap& tap;
    JobClock& clock;
  };
  explicit Switching(const Parts& parts) noexcept : parts_(parts) {}
  /// Takes memory for so many switches; 0: none will be asked for. Context: setup.
  void prepare(std::size_t n_switches);

  /// Makes a plan and begins to carry it out; what became of it is in receipts(). Requires: fewer were asked for than
  /// prepare() took memory for.
  void ask(std::uint32_t set, Nanoseconds now) noexcept;
  /// Goes on with the switch that is under way. No effect without one.
  void step(Nanoseconds now) noexcept;
  /// The run is over: what is not committed is aborted, what is committed is finished.
  void end(Nanoseconds now) noexcept;

  /// From this instant on a step may have something to do; kNever: no switch is under way. Wait-free.
  Nanoseconds due() const noexcept { return due_; }
  /// The next instant at which a step is worth while although no job ends before. Wait-free.
  Nanoseconds wake() const noexcept { return wake_; }
  /// Context: setup, between runs.
  std::span<const SwitchReceipt> receipts() const noexcept { return receipts_.all(); }

  /// How long a step waits for a gap or a value before it gives up.
  static constexpr Nanoseconds kPatience = seconds(10);

 private:
  enum class Phase : std::uint8_t { kNone, kArming, kUndoing, kAfter };

  void plan_parts() noexcept;
  void arm_all(Nanoseconds now) noexcept;
  bool arm(Task& next, Nanoseconds now) noexcept;
  bool may_go_on(Nanoseconds now) noexcept;
  bool has_gap(const Task& task, Method method, Nanoseconds now) const noexcept;
  VariableId lacks_value(Task& task) noexcept;
  bool judge_steps() noexcept;
  ValueStep step_to(const Handover& handover) noexcept;
  void commit(Nanoseconds at) noexcept;
  void abort(NoSwitch why, TaskId of, VariableId variable) noexcept;
  bool turn_off_all(Nanoseconds now, bool at_once) noexcept;
  void look_at_first_cycles() noexcept;
  bool has_seen_first_cycles() noexcept;
  void finish(SwitchEnd end, Nanoseconds now) noexcept;
  bool is_idle() const noexcept;
  void wait(Nanoseconds now) noexcept;
  TaskPart& part_of(TaskId id) noexcept;
  Task& task(TaskId id) noexcept { return parts_.set.tasks()[id.index]; }
  std::uint64_t losses(TaskId id) noexcept;

  Parts parts_;
  SwitchPlanner planner_;
  SwitchReceipts receipts_;
  SwitchPlan plan_;
  SwitchReceipt* receipt_ = nullptr;       // of the switch under way
  std::span<TaskStanding> standing_;       // by task, when a plan is made
  std::span<std::uint64_t> before_;        // by task: losses() when its part of the switch began
  std::span<std::uint64_t> cycles_;        // by task: completed cycles at the instant of the change
  std::span<std::span<std::byte>> last_;   // by variable: the last value of the producer before
  std::span<bool> has_last_;               // by variable
  std::uint32_t n_asked_ = 0;
  std::size_t n_armed_ = 0, n_off_ = 0;
  Nanoseconds first_cycles_by_ = kNever;   // looked for no longer
  Nanoseconds due_ = kNever, wake_ = kNever;
  Phase phase_ = Phase::kNone;
  bool was_raised_ = false;                // the flag, by somebody, when the switch was asked for
};

}  // namespace chimera
