// SPDX-License-Identifier: Apache-2.0
// The illegal-configuration flag as one context sees it: up while the tasks that are ON are no legal set, while a task,
// an operator or a slow switch holds it up, or while it is up in another process.
#pragma once

#include <atomic>
#include <cstdint>
#include <span>

#include "chimera/base/ids.h"
#include "chimera/base/setup_memory.h"
#include "chimera/runtime/application_spec.h"
#include "chimera/task/task.h"

namespace chimera {

/// Context of everything not marked: cycle boundary; no allocation.
class IllegalFlag {
 public:
  /// Down until the first follow(). Everything given outlives this. Context: setup.
  void prepare(std::span<const Variable> variables, std::span<const Task> tasks, SetupMemory& memory);

  /// To be read once for each job. Context: cycle; wait-free; O(other processes).
  bool is_up() const noexcept {
    if (is_up_here_) return true;
    for (const std::atomic<std::uint32_t>* flag : foreign_)
      if (flag->load(std::memory_order_relaxed) != 0) return true;
    return false;
  }
  /// The tasks that are ON over all contexts obey the two set equations, and none that failed lacks a standby, as of
  /// the last follow(). Wait-free.
  bool is_on_set_legal() const noexcept { return is_on_set_legal_; }
  /// A reaction or raise() of this context holds it up, legal or not. Wait-free.
  bool is_raised() const noexcept { return is_raised_ || raised_by_.is_valid(); }
  /// Raises or lowers the part of the flag that does not follow from the ON set. Lowering also ends the holds of tasks.
  void raise(bool up) noexcept;
  /// A slow switch holds it up, in each context, until it is over.
  void hold(bool up) noexcept;
  bool is_held() const noexcept { return is_held_; }
  /// A reaction of the task, of this context, holds it up until that task is no longer in state `in`, ON or ERROR.
  void raise_for(TaskId task, State in) noexcept;
  bool raises(TaskId task) const noexcept { return raises_in_[task.index] != State::kNotCreated; }
  /// The task whose reaction raised it last; invalid: no task does.
  TaskId raised_by() const noexcept { return raised_by_; }
  /// The flag words of the other processes, read from here on by is_up(). The words and the span outlive this.
  void watch(std::span<const std::atomic<std::uint32_t>* const> flags) noexcept { foreign_ = flags; }
  /// `on[t]`: task t is ON, over all contexts. `is_uncovered`: a task that has standbys failed, and none took over.
  /// `configuration`: the number of the one that is ON; kNoSet: none.
  void follow(std::span<const bool> on, bool is_uncovered, std::uint32_t configuration) noexcept;
  /// The configuration in force at the last follow(). While a slow switch holds the flag, the states are a mixture, and
  /// the one before it stays. Context: any; wait-free.
  std::uint32_t configuration() const noexcept { return configuration_.load(std::memory_order_relaxed); }

 private:
  void lower(bool for_all) noexcept;
  void judge() noexcept { is_up_here_ = is_raised() || is_held_ || !is_on_set_legal_; }

  std::span<const Variable> variables_;
  std::span<const Task> tasks_;
  // Relaxed, pair with nothing: a job that reads one a cycle late is a job that ran a cycle earlier.
  std::span<const std::atomic<std::uint32_t>* const> foreign_;
  std::span<State> raises_in_;  // by task: its reaction holds the flag up in this state; NOT-CREATED: it does not
  std::atomic<std::uint32_t> configuration_{UINT32_MAX};  // relaxed, pairs with nothing: as `foreign_`
  TaskId raised_by_;          // one of them
  bool is_raised_ = false;
  bool is_held_ = false;
  bool is_on_set_legal_ = true;
  bool is_up_here_ = false;  // result of the words above, for every job
};

}  // namespace chimera
