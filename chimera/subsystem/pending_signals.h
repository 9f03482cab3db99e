// SPDX-License-Identifier: Apache-2.0
// Signals that were sent and are not reported on yet.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "chimera/base/ids.h"
#include "chimera/base/time.h"
#include "chimera/task/signal.h"

namespace chimera::subsystem {

struct PendingSignal {
  std::uint64_t command = 0;
  Signal signal = Signal::kOn;
  Nanoseconds sent;
  Nanoseconds due;  ///< kNever: given up waiting, though it may still be carried out
};

/// Posts of one sender to one rtpu are taken in their order: a report on one tells that all before it were taken, so
/// that those given up are over too.
/// Context: setup.
class PendingSignals {
 public:
  explicit PendingSignals(std::size_t n_tasks) : tasks_(n_tasks) {}

  /// Numbers never repeat, over managers too: each begins at its own instant of start.
  void begin(Nanoseconds now) noexcept { last_ = now.count > 0 ? static_cast<std::uint64_t>(now.count) : 0; }
  /// Returns the number of the command.
  std::uint64_t post(Signal signal, std::span<const TaskId> tasks, Nanoseconds now);
  /// Takes the entry of `command` away. False: nobody waits for it any more.
  bool settle(TaskId task, std::uint64_t command);
  void drop(TaskId task) { tasks_[task.index].clear(); }

  std::vector<PendingSignal>& of(TaskId task) noexcept { return tasks_[task.index]; }
  /// Is an answer awaited?
  bool is_awaited(TaskId task) const noexcept;
  bool is_awaited(TaskId task, Signal signal) const noexcept;
  /// Sent and not known to be over, given up or not.
  bool is_possible(TaskId task, Signal signal) const noexcept;
  Nanoseconds next_due() const noexcept;

 private:
  std::uint64_t last_ = 0;
  std::vector<std::vector<PendingSignal>> tasks_;
};

}  // namespace chimera::subsystem
