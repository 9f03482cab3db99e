// SPDX-License-Identifier: Apache-2.0
// The states to which tasks must be brought. ManagerLoop remembers them, so that a goal outlives the manager.
#pragma once

#include <vector>

#include "chimera/subsystem/subsystem_state.h"

namespace chimera::subsystem {

/// Goal bit beside kGoalSpawn and kGoalOn: a person killed the task after its process died, so it is not missed.
inline constexpr std::uint32_t kGoalGone = 4;
/// Time after which a started rtpu that does not serve is given up.
inline constexpr Nanoseconds kStartLimit = seconds(10);

/// Context: setup.
class Goals {
 public:
  Goals(SubsystemState& state) : state_(state), goals_(state.spec.tasks.size()) {}

  void recall(std::span<const std::uint32_t> remembered);
  /// Replaces the goal; kGoalOff stays. False if the task had this goal already.
  bool set(TaskId task, std::uint32_t goal) { return write(task, goal | (of(task) & kGoalOff)); }
  bool add(TaskId task, std::uint32_t bits) { return write(task, of(task) | bits); }
  bool clear(TaskId task, std::uint32_t bits) { return write(task, of(task) & ~bits); }
  std::uint32_t of(TaskId task) const noexcept { return goals_[task.index].bits; }
  bool has(TaskId task, std::uint32_t bits) const noexcept { return (of(task) & bits) != 0; }
  bool is_pursued(TaskId task) const noexcept { return has(task, kGoalSpawn | kGoalOn); }
  bool any(std::uint32_t bits) const noexcept;
  std::vector<TaskId> with(std::uint32_t bits) const;

  /// Logs the reason first, then gives up the goals of the task. If the manager dies between the two, the next manager
  /// logs it again.
  void fail(TaskId task, const SignalRefusal& why);
  /// Reason why the last goals of the task were given up; kNone if they were reached.
  const SignalRefusal& failure(TaskId task) const noexcept { return goals_[task.index].failure; }

  /// Sends every spawn that may go. Notices goals that are reached and rtpus that do not come. False if nothing
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
  bool write(TaskId task, std::uint32_t goal);
  bool advance(TaskId task);
  bool wait_for(TaskId task, TaskId rival);
  bool has_constants(TaskId task) const noexcept;

  SubsystemState& state_;
  std::vector<Goal> goals_;
};

}  // namespace chimera::subsystem
