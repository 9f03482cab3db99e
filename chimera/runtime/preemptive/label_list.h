// SPDX-License-Identifier: Apache-2.0
// Chooses the priority level ("label") of every ready job of one processor, so that the kernel dispatches in order of
// urgency: the order of levels is the order of urgency. Pure bookkeeping; the owner passes changes to the kernel.
//
//   entry 0 ... np-1 | np ... n-1        ascending urgency
//   parked: the base   levels strictly between base and ceiling, strictly ascending
//
// New jobs take a free level between their neighbours. Where none is free a few neighbours move by one level; where
// that would take too many, the least urgent ones share the base ("parked") until there is room again. Parked jobs
// are all less urgent than the labelled ones, so only the order among them is lost, and it returns by promotion.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "chimera/base/ids.h"
#include "chimera/schedule/policy.h"

namespace chimera {

/// A ready job and where it runs.
struct LabelledJob {
  TaskId task;
  Urgency urgency;
  std::uint64_t tie = 0;  // tie_of() the task
  std::int32_t level = 0;
};

/// A change for the kernel, to be made in this order.
struct LevelChange {
  TaskId task;
  std::int32_t level = 0;
};

/// Context: setup for construction; everything else cycle, wait-free, O(ready jobs), no allocation.
class LabelList {
 public:
  /// Moves of other jobs that one insertion makes to find a free level, before it parks instead.
  static constexpr std::size_t kFewMoves = 4;

  /// Jobs of at most `capacity` tasks, at levels base (parked) and base+1 .. ceiling-1. Requires: ceiling - base >= 2.
  LabelList(Policy policy, std::size_t capacity, std::int32_t base, std::int32_t ceiling);

  /// Adds a job. Returns the changes, the new job's own level last. Requires: no job of this task is in the list.
  std::span<const LevelChange> insert(const LabelledJob& job) noexcept;
  /// Removes the task's job. Returns the changes of others; empty also if it had none.
  std::span<const LevelChange> remove(TaskId task) noexcept;
  /// The urgency of a job changed: moves it to its new place. No effect for a task without a job.
  std::span<const LevelChange> rekey(TaskId task, const Urgency& urgency) noexcept;
  /// This task's job has begun and has the processor (invalid: no job has): at equal urgency it goes on.
  void dispatch(TaskId task) noexcept { running_ = task; }

  std::size_t size() const noexcept { return jobs_.size(); }
  /// Ascending urgency: the last one is the most urgent.
  std::span<const LabelledJob> jobs() const noexcept { return jobs_; }
  std::size_t parked() const noexcept { return n_parked_; }
  Policy policy() const noexcept { return policy_; }

 private:
  bool goes_before(const LabelledJob& a, const LabelledJob& b) const noexcept;
  std::size_t place_of(const LabelledJob& job) const noexcept;
  std::size_t find(TaskId task) const noexcept;
  std::int32_t below(std::size_t at) const noexcept { return at > n_parked_ ? jobs_[at - 1].level : base_; }
  std::int32_t above(std::size_t at) const noexcept { return at < jobs_.size() ? jobs_[at].level : ceiling_; }
  void set(std::size_t at, std::int32_t level) noexcept;
  void label(std::size_t at) noexcept;
  bool make_room(std::size_t at, std::size_t most_moves) noexcept;
  void park_up_to(std::size_t end) noexcept;
  void take_out(std::size_t at) noexcept;
  void promote() noexcept;

  Policy policy_;
  std::int32_t base_, ceiling_;
  std::vector<LabelledJob> jobs_;      // capacity reserved once
  std::vector<LevelChange> changes_;   // capacity reserved once
  std::size_t n_parked_ = 0;
  TaskId running_;
};

}  // namespace chimera
