// SPDX-License-Identifier: Apache-2.0
// Keeps the record of the switch that is under way in one context: durations of methods, lost cycles, and the step of
// each variable. The result is a receipt.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <span>

#include "chimera/runtime/job/job_threads.h"
#include "chimera/runtime/life/task_set.h"
#include "chimera/runtime/plan/switch_receipt.h"

namespace chimera {

/// A first cycle that comes later than this after its task went ON is not waited for, so that the requester gets an
/// answer.
inline constexpr Nanoseconds kFirstCycleWithin = seconds(1);

/// Until when the first cycle of a task that goes ON at `at` is waited for. Context: any; wait-free.
inline Nanoseconds first_cycle_by(const TaskSpec& task, Nanoseconds at) noexcept {
  return task.aperiodic ? at : at + std::min(task.period + task.deadline, kFirstCycleWithin);
}
/// Releases of the run without a completed cycle. Jobs count them also during a cycle boundary. Context: any;
/// wait-free.
inline std::uint64_t losses_of(Task& task) noexcept {
  return count_of(task.profile.dropped) + count_of(task.profile.aborted);
}

/// Compares the first `count` elements of an out-var. A boolean counts as 0 or 1; of a struct every field counts.
/// `declared` is the component's declaration of the port. Requires: max_bytes() of the port at both. Context: cycle
/// boundary; wait-free; O(elements).
ValueStep step_between(const PortSpec& port, const chimera_port_decl& declared, std::uint32_t count,
                       const std::byte* before, const std::byte* after) noexcept;

/// Measures the step of each variable that is handed over in a switch: from the last value of the old producer to the
/// value that the new producer wrote. For the tasks of one context. Context of everything not marked: cycle boundary;
/// O(bytes of the variables); no allocation.
class HandoverSteps {
 public:
  explicit HandoverSteps(TaskSet& set) noexcept : set_(set) {}
  /// Takes memory for every variable. Context: setup.
  void prepare();

  /// Keeps the last publications of the present producers of the variables. Requires: they are the old producers.
  void keep_last(std::span<const VariablePart> variables) noexcept;
  /// Keeps the last value of one variable, whose producer in this context has gone.
  void keep_last_of(const Handover& handover) noexcept;
  /// Compares the last publications of the old producers with those at the last call. A step between two publications
  /// in a row that is larger than `usual` replaces it. For variables that go to a task of this context.
  void watch(std::span<VariablePart> variables) noexcept;
  /// Keeps the last value that watch() saw of a producer in another context, which has gone.
  void keep_watched(const Handover& handover) noexcept;
  /// Forgets all values that watch() has seen.
  void begin_watch() noexcept;
  /// From the kept value to the latest one of the new producer, a task of this context. Not known if one of the two is
  /// missing.
  ValueStep step_to(const Handover& handover) noexcept;

 private:
  ValueStep step(const Handover& handover, const std::byte* from, const std::byte* to) const noexcept;
  void keep(const Handover& handover, const chimera_slot* slot, std::uint32_t offset, std::uint32_t bit) noexcept;

  TaskSet& set_;
  std::span<std::span<std::byte>> last_;  // by variable
  std::span<bool> has_last_;              // by variable
  std::span<std::span<std::byte>> watched_;     // by variable
  std::span<std::uint64_t> watched_sequence_;  // by variable: of the publication that is in watched_; 0: none
};

/// Start delays of cycles within a window: from release to start. Cycle boundaries read count, sum and maximum of the
/// profile, so that a job pays nothing. If there were several cycles between two calls of look(), their mean counts,
/// unless one was the longest of the run.
/// Context of everything not marked: cycle boundary; wait-free. Requires: no job of the task is under way.
class StartDelays {
 public:
  /// Context: setup.
  void prepare(std::size_t n_tasks, SetupMemory& memory) { seen_ = memory.take<Spread>(n_tasks); }
  /// A window of the task begins with the next look(): a job of it may be under way until then.
  void begin_later(TaskId task) noexcept { seen_[task.index].count = kNotBegun; }
  /// A window of the task begins. Returns the longest start delay of the run up to now; -1: it had no cycle.
  Nanoseconds begin(const Task& task) noexcept;
  /// The longest start delay since the last look(); -1: there was no cycle.
  Nanoseconds look(const Task& task) noexcept;

 private:
  static constexpr Count kNotBegun = ~Count{0};
  std::span<Spread> seen_;  // by task: its start_delay at the last look
};

/// Records the part of the tasks of its own context. Context of everything not marked: cycle boundary; no allocation.
class SwitchRecord {
 public:
  explicit SwitchRecord(TaskSet& set) noexcept : set_(set), steps_(set) {}
  /// Context: setup.
  void prepare();

  /// Starts the receipt of another switch, which replaces the last one.
  SwitchReceipt& restart() noexcept;
  SwitchReceipt& receipt() noexcept { return *receipt_; }
  const SwitchReceipt& receipt() const noexcept { return *receipt_; }

  /// Lists the tasks and variables of the plan. Losses count from here.
  void take_up(const SwitchPlan& plan) noexcept;
  /// Follows start delays of the tasks and, until the change, steps of the variables. Call it at each cycle boundary of
  /// the switch.
  void watch() noexcept;
  void took(TaskId task, Method method, Nanoseconds time) noexcept;
  /// Compares the values that `on` of the arriving tasks wrote with the last values. Null: all within their limits.
  const VariablePart* find_too_large_step() noexcept;
  // Of a slow switch, in which one task goes after the other.

  /// Keeps the present values of leaving producers.
  void keep_last() noexcept { steps_.keep_last(receipt_->variables); }
  /// The task, of this context, is about to go OFF.
  void leaves(TaskId task) noexcept;
  /// The task, of this context, went ON. Returns its variable that moved too far; null: none did.
  const VariablePart* arrives(TaskId task, Nanoseconds now) noexcept;
  void reinitialised(TaskId task) noexcept;

  /// The change took place at `at`: first cycles count from here on.
  void changed(const SwitchPlan& plan, Nanoseconds at) noexcept;
  /// Leaving tasks of this context may have published once more, in jobs released before the change.
  void keep_last_of_leaving() noexcept;
  /// Notes the steps of first cycles. True: no first cycle is waited for any more.
  bool has_seen_first_cycles(Nanoseconds now) noexcept;
  /// Asks for a cycle boundary after each first cycle that has_seen_first_cycles() waits for.
  void await_first_cycles(JobThreads& threads) noexcept;
  /// No first cycle is waited for beyond this instant.
  Nanoseconds first_cycles_by() const noexcept { return first_cycles_by_; }
  void end(SwitchEnd end, Nanoseconds now) noexcept;

 private:
  void follow_arrival(TaskId id, Nanoseconds at) noexcept;
  TaskPart& part_of(TaskId id) noexcept;
  std::uint64_t losses(TaskId id) const noexcept { return losses_of(set_.tasks()[id.index]); }
  bool has_cycled(TaskId id) const noexcept;
  bool is_awaited(const TaskPart& part) const noexcept;

  TaskSet& set_;
  HandoverSteps steps_;
  StartDelays delays_;
  SwitchReceipts receipts_;  // one
  SwitchReceipt* receipt_ = nullptr;
  std::span<std::uint64_t> before_;  // by task: losses() when its part of the switch began
  std::span<std::uint64_t> cycles_;  // by task: completed cycles at the instant of the change
  Nanoseconds first_cycles_by_ = kNever;
};

}  // namespace chimera
