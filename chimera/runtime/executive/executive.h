// SPDX-License-Identifier: Apache-2.0
// The dynamic scheduling executive in real time: all tasks of one context in one loop, no preemption.
// While tasks are ON the framework makes no allocation, takes no lock, throws nothing and calls the system for
// nothing but the clock and the wait.
#pragma once

#include "chimera/platform/clock.h"
#include "chimera/runtime/cycle/releases.h"

namespace chimera {

/// The clock of methods in real time, and Cycle::spend(): it computes until the time is used up.
class ComputingClock final : public JobClock {
 public:
  explicit ComputingClock(Clock& clock) noexcept : clock_(clock) {}
  Nanoseconds now() noexcept override { return clock_.now(); }
  void spend(Nanoseconds time) noexcept override {
    const Nanoseconds end = clock_.now() + time;
    while (clock_.now() < end) {
    }
  }

 private:
  Clock& clock_;
};

/// Runs the tasks of `set` on `clock`. The set, the clocks and all pointers of the options outlive it.
class Executive {
 public:
  /// `job_clock` is `clock` as methods see it: ComputingClock, or a twin that steps it. Context: setup.
  Executive(TaskSet& set, Clock& clock, JobClock& job_clock, const RunOptions& options);

  /// Spawns all tasks and turns the start set ON; the grid of releases begins when that is done. Refused as
  /// TaskLife::start. Context: setup; as long as init and on take.
  SignalReport start();
  /// Begins with nothing spawned, on a grid of releases that others share. Context: setup.
  void start(Nanoseconds origin) { releases_.begin(origin); }
  Releases& releases() noexcept { return releases_; }
  /// Runs for `duration` from the origin of the grid; kNever: without limit. May be called again to go on.
  /// Context: cycle; returns when RunEnd says so.
  RunEnd run(Nanoseconds duration) noexcept;
  /// off and kill for every task. Context: setup.
  void shut_down() {
    releases_.end(clock_.now());
    set_.life().shut_down(clock_.now());
  }

  /// When the grid of releases began. Context: any.
  Nanoseconds origin() const noexcept { return releases_.origin(); }
  /// Context: setup, between runs.
  std::span<const RefusedSignal> refused() noexcept { return releases_.signals().refused(); }
  /// Receipts of all requested switches. Context: setup, between runs.
  const SwitchReceipts& receipts() noexcept { return releases_.receipts(); }

 private:
  TaskSet& set_;
  Clock& clock_;
  Releases releases_;
};

}  // namespace chimera
