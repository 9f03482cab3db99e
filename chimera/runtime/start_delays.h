// SPDX-License-Identifier: Apache-2.0
// How long after their releases the cycles of tasks start within a window, seen from edges, so that a job pays nothing
// for it: from count, sum and maximum of the profile. Of several cycles between two looks their mean counts, unless one
// was the longest of the run.
#pragma once

#include <span>

#include "chimera/base/setup_memory.h"
#include "chimera/task/task.h"

namespace chimera {

/// Context of everything not marked: cycle boundary; wait-free. Requires: no job of the task is under way.
class StartDelays {
 public:
  /// Context: setup.
  void prepare(std::size_t n_tasks, SetupMemory& memory) { seen_ = memory.take<Spread>(n_tasks); }
  /// A window of the task begins with the next look(): a job of it may be under way until then.
  void begin_later(TaskId task) noexcept { seen_[task.index].count = kNotBegun; }
  /// A window of the task begins. The longest of the run so far; -1: it had no cycle.
  Nanoseconds begin(const Task& task) noexcept;
  /// The longest since the last look; -1: there was no cycle.
  Nanoseconds look(const Task& task) noexcept;

 private:
  static constexpr std::uint64_t kNotBegun = UINT64_MAX;
  std::span<Spread> seen_;  // by task: its start_delay at the last look
};

}  // namespace chimera
