// SPDX-License-Identifier: Apache-2.0
// What follows the end of the process of an rtpu: what its tasks are to be brought back to; a restart, at most three in
// 10 s, or none until a person asks for it.
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
  /// False: known already.
  bool on_rtpu_down(const RtpuDown& down);
  /// Asks for a dead rtpu that has goals, with what is left of its budget.
  void start_for_goals(RtpuId rtpu);
  /// What to type so that what it had comes back; `chimera spawn` of its tasks where nothing is known to be lost.
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
  std::vector<bool> was_on_;  // by task, when its process died
};

}  // namespace chimera::subsystem
