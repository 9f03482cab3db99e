// SPDX-License-Identifier: Apache-2.0
// Decides what follows the death of an rtpu: the goals of its tasks, and a restart. It allows three restarts in 10 s,
// then none until a person asks for one.
#pragma once

#include <string>
#include <vector>

#include "chimera/subsystem/command_queue.h"
#include "chimera/subsystem/goals.h"
#include "chimera/subsystem/on_transaction.h"
#include "chimera/subsystem/subsystem_state.h"

namespace chimera::subsystem {

/// Context: setup.
class RestartPolicy {
 public:
  RestartPolicy(SubsystemState& state, Goals& goals, OnTransaction& transaction, CommandQueue& commands);

  void recall(const Begun& begun);
  /// False if this death was known already.
  bool on_rtpu_down(const RtpuDown& down);
  /// Requests the start of a dead rtpu whose tasks have goals.
  void start_for_goals(RtpuId rtpu);
  /// Commands that bring the lost tasks of the rtpu back; `chimera spawn` of all its tasks if none is known to be lost.
  std::string way_back(RtpuId rtpu) const;

 private:
  bool is_of(TaskId task, RtpuId rtpu) const noexcept { return state_.observed.rtpu(task) == rtpu; }
  std::uint32_t goal_after(TaskId task) const;
  void restart(const RtpuDown& down, const std::vector<std::uint32_t>& goals);
  void leave_off_for(TaskId task);
  void give_up(const RtpuDown& down);
  int recent(RtpuId rtpu) const noexcept;

  SubsystemState& state_;
  Goals& goals_;
  OnTransaction& transaction_;
  CommandQueue& commands_;
  std::vector<std::uint32_t> handled_;
  std::vector<bool> was_on_;  // by task: it was ON when its process died
};

}  // namespace chimera::subsystem
