// SPDX-License-Identifier: Apache-2.0
// The guard's reports as events: docs/formats/processes.md, "The guard".
#pragma once

#include <string>

#include "chimera/manager/state/manager_state.h"
#include "chimera/rtpu/keeper_message.h"
#include "chimera/text/json.h"

namespace chimera::manager {

/// Logs an event of the kind `safe` for kFramesWritten and kSilent; ignores other messages. Context: setup.
void tell_of_guard(ManagerState& state, const KeeperMessage& message, Nanoseconds now);

/// Reason why the guard could not write the safe frames of an rtpu, and the remedy. No reason: it could.
struct NoGuard {
  std::string why, remedy;
};
NoGuard no_guard(const ManagerState& state, RtpuId rtpu);
/// The reason that concerns this rtpu alone: "no safe frame can be written: Too many open files"; "" if there is none.
std::string unguarded_text(const ManagerState& state, RtpuId rtpu);

/// The state of the guard, as the keeper page shows it.
class GuardWatch {
 public:
  /// Logs each lack once in the life of a manager: the guard is late or dead, or an rtpu has none. Context: setup.
  void look(ManagerState& state, Nanoseconds at);

 private:
  GuardState shown_ = GuardState::kWell;
  std::int32_t unguarded_[kMaxRtpus] = {};
};

/// {"pid", "lack", "hang"}, or null if the subsystem has no guard: docs/formats/control.md.
Json guard_json(const ManagerState& state);

}  // namespace chimera::manager
