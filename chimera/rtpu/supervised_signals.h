// SPDX-License-Identifier: Apache-2.0
// Carries out signals at a cycle boundary and publishes the method of each to the supervising thread of the rtpu,
// because the method may hang.
#pragma once

#include <atomic>
#include <cstdint>
#include <span>

#include "chimera/rtpu/peer_links.h"
#include "chimera/runtime/cycle/boundary_signals.h"

namespace chimera {

/// Both arguments outlive this object.
class SupervisedSignals {
 public:
  SupervisedSignals(TaskSet& tasks, PeerLinks& others) noexcept : tasks_(tasks), others_(others) {}

  /// Carries out `signal` and publishes the changes. Context: cycle boundary; takes as long as the methods.
  SignalReport carry_out(BoundarySignals& signals, std::span<const TaskId> tasks, Signal signal,
                         Nanoseconds now) noexcept;

  // Context of both: any thread; wait-free.
  /// Grows at the begin and at the end of each signal that a cycle boundary carries out.
  std::uint32_t progress() const noexcept { return progress_; }
  /// The method that runs, as BlockHead::running; 0: none.
  std::uint32_t acting() const noexcept { return acting_; }

 private:
  TaskSet& tasks_;
  PeerLinks& others_;
  // A cycle boundary stores them, the main thread reads them (HangWatch); they pair with nothing.
  std::atomic<std::uint32_t> progress_{0}, acting_{0};
};

}  // namespace chimera
