// SPDX-License-Identifier: Apache-2.0
// What tasks are to be brought to. Remembered by the driver, so that a goal outlives the manager.
#pragma once

#include <vector>

#include "chimera/subsystem/subsystem_state.h"

namespace chimera::subsystem {

/// Beside kGoalSpawn and kGoalOn: killed by a person after its process died, so it is not missed.
inline constexpr std::uint32_t kGoalGone = 4;
/// An rtpu that was asked for and does not serve within this time is not waited for any longer.
inline constexpr Nanoseconds kStartLimit = seconds(10);
/// A task whose `on` answers not yet is asked again for so long.
inline constexpr Nanoseconds kReadyLimit = seconds(10);

/// Context: setup.
class Goals {
 public:
  Goals(SubsystemState& state) : state_(state), goals_(state.spec.tasks.size()) {}

  void recall(std::span<const std::uint32_t> remembered);
  /// False: the task had this goal already.
  bool set(TaskId task, std::uint32_t goal);
  bool add(TaskId task, std::uint32_t bits) { return set(task, of(task) | bits); }
  bool clear(TaskId task, std::uint32_t bits) { return set(task, of(task) & ~bits); }
  std::uint32_t of(TaskId task) const noexcept { return goals_[task.index].bits; }
  bool has(TaskId task, std::uint32_t bits) const noexcept { return (of(task) & bits) != 0; }
  bool is_pursued(TaskId task) const noexcept { return has(task, kGoalSpawn | kGoalOn); }
  bool any(std::uint32_t bits) const noexcept;
  std::vector<TaskId> with(std::uint32_t bits) const;

  /// Logs why and gives the goals of the task up, in this order: a manager that dies between the two lets the next one
  /// log it again.
  void fail(TaskId task, const SignalRefusal& why);
  /// Why the last goals of the task were given up; kNone when they were reached.
  const SignalRefusal& failure(TaskId task) const noexcept { return goals_[task.index].failure; }

  /// Sends every spawn that can be sent; notices goals that are reached or whose rtpu does not come. False: nothing
  /// changed.
  bool advance();
  void on_result(const SignalResult& result);
  Nanoseconds next_due() const noexcept;

 private:
  struct Goal {
    std::uint32_t bits = 0;
    std::uint64_t command = 0;  ///< of its spawn
    SignalRefusal failure;
    Nanoseconds waits_since = kNever;  ///< for a rival to be killed
  };
  bool advance(TaskId task);
  bool wait_for(TaskId task, TaskId rival);
  bool has_constants(TaskId task) const noexcept;

  SubsystemState& state_;
  std::vector<Goal> goals_;
};

}  // namespace chimera::subsystem
