// SPDX-License-Identifier: Apache-2.0
// The tasks of one context in virtual time: the same job step, policies and reactions as in real time, with modelled
// execution times (virtual/modelled_clock.h). Time starts at 0 and a run repeats exactly.
#pragma once

#include "chimera/runtime/cycle/releases.h"
#include "chimera/runtime/virtual/modelled_clock.h"
#include "chimera/runtime/virtual/preemptive.h"

namespace chimera {

/// Options of virtual time. Context: setup.
struct VirtualOptions {
  bool preemptive = false;
  std::optional<JobTimes> times;          ///< execution times in place of the budgets
  Nanoseconds quantum = milliseconds(1);  ///< of the laxity policies, preemptive only; > 0
};

/// Non-preemptive: the loop of the executive, job by job. Preemptive: virtual/preemptive.h.
class VirtualExecutor {
 public:
  /// The set and all pointers of the options outlive it. Requires: preemptive, where a task has a server. Context:
  /// setup.
  VirtualExecutor(TaskSet& set, const RunOptions& options, const VirtualOptions& how);

  /// Spawns all tasks and turns the start set ON; what their methods spend is the origin of the grid, else 0.
  /// Refuses as TaskLife::start. Context: setup.
  Result<void> start();
  /// Runs for `duration` from the origin of the grid; kNever: until nothing is left. No job starts at or after the
  /// end; one under way there is finished (non-preemptive) or cut (preemptive). May be called again to go on.
  /// Context: cycle.
  RunEnd run(Nanoseconds duration) noexcept;
  /// off and kill for every task. Context: setup.
  void shut_down() {
    clock_.set(now_);
    releases_.end(now_);
    set_.life().shut_down(now_);
  }

  /// Context: any.
  Nanoseconds now() const noexcept { return now_; }
  Nanoseconds origin() const noexcept { return releases_.origin(); }
  /// Context: setup, between runs.
  std::span<const RefusedSignal> refused() noexcept { return releases_.signals().refused(); }
  /// Receipts of all requested switches. Context: setup, between runs.
  const SwitchReceipts& receipts() noexcept { return releases_.receipts(); }

 private:
  TaskSet& set_;
  VirtualOptions how_;
  ModelledClock clock_;
  Releases releases_;
  Preemptive preemptive_;
  Nanoseconds now_;
};

}  // namespace chimera
