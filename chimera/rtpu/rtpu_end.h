// SPDX-License-Identifier: Apache-2.0
// The end of an rtpu: turns its tasks OFF in reverse data-flow order over the whole application, then kills them.
// docs/formats/processes.md, "Ending".
#pragma once

#include <atomic>

#include "chimera/rtpu/hanging_jobs.h"
#include "chimera/rtpu/supervised_signals.h"

namespace chimera {

/// All arguments outlive this object.
class RtpuEnd {
 public:
  RtpuEnd(TaskSet& tasks, PeerLinks& others, SupervisedSignals& supervised, const HangingJobs& hanging,
          Nanoseconds method_limit) noexcept
      : tasks_(tasks), others_(others), supervised_(supervised), hanging_(hanging), method_limit_(method_limit) {}

  /// From now on all tasks of the rtpu end. `is_alone`: the other rtpus go on, and a successor turns the tasks that are
  /// ON now ON again. A second call may change it. Context: any thread; wait-free.
  void tell(bool is_alone) noexcept {
    is_alone_ = is_alone;
    is_told_ = true;
  }
  bool is_told() const noexcept { return is_told_; }
  /// Set when all tasks are killed: RunOptions::stop of the loop. Context: any thread.
  const std::atomic<bool>& is_over() const noexcept { return over_; }

  /// Carries out the steps of the end that are possible at this boundary. True when the last one is done. Requires:
  /// is_told(). Context: cycle boundary; takes as long as the methods.
  bool go_on(BoundarySignals& signals, Nanoseconds now) noexcept;

 private:
  bool is_awaited(TaskId id, Nanoseconds now) noexcept;
  bool turn_off_next(BoundarySignals& signals, Nanoseconds now) noexcept;
  bool kill_next(BoundarySignals& signals, Nanoseconds now) noexcept;

  TaskSet& tasks_;
  PeerLinks& others_;
  SupervisedSignals& supervised_;
  const HangingJobs& hanging_;
  const Nanoseconds method_limit_;
  bool has_begun_ = false;
  std::size_t next_off_ = 0;  // in ApplicationSpec::end_order
  Nanoseconds patience_;      // end of the wait for tasks of others and for late jobs
  std::uint32_t passed_over_ = 0;  // bit: an rtpu that is not waited for any more
  // The main thread calls tell(), boundaries read. Sequentially consistent: a reader that sees is_told_ also sees
  // is_alone_.
  std::atomic<bool> is_told_{false};
  std::atomic<bool> is_alone_{false};
  // A boundary stores it; the loop (RunOptions::stop) and the main thread load it. It pairs with nothing.
  std::atomic<bool> over_{false};
};

}  // namespace chimera
