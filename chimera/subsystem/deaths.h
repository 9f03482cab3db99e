// SPDX-License-Identifier: Apache-2.0
// What follows the death of an rtpu: what its tasks are to be brought back to, a restart or the end of patience.
#pragma once

#include <string>
#include <vector>

#include "chimera/subsystem/acts.h"
#include "chimera/subsystem/goals.h"
#include "chimera/subsystem/situation.h"
#include "chimera/subsystem/transaction.h"

namespace chimera::subsystem {

/// Context: setup.
class Deaths {
 public:
  Deaths(Situation& situation, Goals& goals, Transaction& transaction, Acts& acts);

  void recall(const Begun& begun);
  /// False: known already.
  bool take(const RtpuDown& down);
  /// Asks for a dead rtpu that has goals, with what is left of its budget.
  void start_for_goals(RtpuId rtpu);
  /// What to type so that what it had comes back; "": nothing was lost.
  std::string way_back(RtpuId rtpu) const;

 private:
  bool is_of(TaskId task, RtpuId rtpu) const noexcept { return at_.roster.rtpu(task) == rtpu; }
  std::uint32_t goal_after(TaskId task) const;
  void restart(const RtpuDown& down, const std::vector<std::uint32_t>& goals);
  void give_up(const RtpuDown& down);
  int recent(RtpuId rtpu) const noexcept;

  Situation& at_;
  Goals& goals_;
  Transaction& transaction_;
  Acts& acts_;
  std::vector<std::uint32_t> handled_;
  std::vector<bool> was_on_;  // by task, when its process died
};

}  // namespace chimera::subsystem
