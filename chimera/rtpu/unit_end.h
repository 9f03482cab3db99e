// SPDX-License-Identifier: Apache-2.0
// The end of a unit: turns its tasks OFF in reverse data-flow order over the whole application, then kills them.
// docs/formats/processes.md, "Ending".
#pragma once

#include <atomic>

#include "chimera/rtpu/hanging_jobs.h"
#include "chimera/rtpu/supervised_signals.h"

namespace chimera {

/// Everything given outlives this.
class UnitEnd {
 public:
  UnitEnd(TaskSet& tasks, PeerLinks& others, SupervisedSignals& supervised, const HangingJobs& hanging,
          Nanoseconds method_limit) noexcept
      : tasks_(tasks), others_(others), supervised_(supervised), hanging_(hanging), method_limit_(method_limit) {}

  /// From now on all tasks of the unit end. `is_alone`: the others go on, and a successor brings back what is ON now;
  /// may be said again. Context: any thread; wait-free.
  void tell(bool is_alone) noexcept {
    is_alone_ = is_alone;
    is_told_ = true;
  }
  bool is_told() const noexcept { return is_told_; }
  /// Set when all tasks are killed: the loop's RunOptions::stop. Context: any thread.
  const std::atomic<bool>& is_over() const noexcept { return over_; }

  /// Does what can be done at this boundary; true when that was the last. Requires: is_told(). Context: cycle boundary;
  /// as long as the methods take.
  bool go_on(BoundarySignals& signals, Nanoseconds now) noexcept;

 private:
  bool turn_off_next(BoundarySignals& signals, Nanoseconds now) noexcept;
  bool kill_next(BoundarySignals& signals, Nanoseconds now) noexcept;

  TaskSet& tasks_;
  PeerLinks& others_;
  SupervisedSignals& supervised_;
  const HangingJobs& hanging_;
  const Nanoseconds method_limit_;
  bool has_begun_ = false;
  std::size_t next_off_ = 0;  // in ApplicationSpec::end_order
  Nanoseconds patience_;      // with the tasks of others
  // tell() by the main thread, read at boundaries: sequentially consistent, so that is_alone_ is seen with is_told_.
  std::atomic<bool> is_told_{false};
  std::atomic<bool> is_alone_{false};
  // Stored at a boundary, loaded by the loop (RunOptions::stop) and by the main thread; pairs with nothing.
  std::atomic<bool> over_{false};
};

}  // namespace chimera
