// SPDX-License-Identifier: Apache-2.0
// The changes of one cycle boundary that other processes must see, as a list. Nothing is published where something
// changes; the BoundaryListener publishes the list and clears it.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

#include "chimera/base/ids.h"
#include "chimera/base/setup_memory.h"
#include "chimera/runtime/task_status.h"

namespace chimera {

/// One thing that changed.
struct Change {
  enum class Kind : std::uint8_t {
    kStatus,  ///< of the task: from `before` to `now`
    kFault,   ///< the fault record of the task has a new fault or note
    kFlag,    ///< the illegal-configuration flag was judged anew, and may be another
  };
  Kind kind = Kind::kFlag;
  TaskId task;  ///< invalid for kFlag
  TaskStatus before, now;
};

/// Changes in the order of their first occurrence. A change that repeats before publication keeps its first place with
/// its latest status. Context of everything not marked: cycle boundary; O(changes); no allocation.
class Changes {
 public:
  /// Room for everything that `n_tasks` tasks can change. Nothing is listed before that. Context: setup.
  void prepare(std::size_t n_tasks, SetupMemory& memory) { places_ = memory.take<Change>(2 * n_tasks + 1); }

  void add_status(TaskId task, TaskStatus before, TaskStatus now) noexcept {
    if (Change* listed = add(Change::Kind::kStatus, task, before)) listed->now = now;
  }
  void add_fault(TaskId task) noexcept { (void)add(Change::Kind::kFault, task, {}); }
  void add_flag() noexcept { (void)add(Change::Kind::kFlag, TaskId(), {}); }

  bool is_empty() const noexcept { return n_ == 0; }
  std::span<const Change> list() const noexcept { return {places_.data(), n_}; }
  /// All of them are published.
  void clear() noexcept { n_ = 0; }

 private:
  // The place in the list; null before prepare().
  Change* add(Change::Kind kind, TaskId task, TaskStatus before) noexcept {
    for (std::size_t i = 0; i < n_; ++i)
      if (places_[i].kind == kind && places_[i].task == task) return &places_[i];
    if (n_ == places_.size()) return nullptr;
    places_[n_] = {kind, task, before, before};
    return &places_[n_++];
  }

  std::span<Change> places_;
  std::size_t n_ = 0;  // of them are listed
};

}  // namespace chimera
