// SPDX-License-Identifier: Apache-2.0
// Requests for switches by tasks and reactions. They are words in the blocks of the rtpus. The manager carries out the
// last request as a switch and remembers which ones it has handled; a successor finds the open ones.
// docs/formats/processes.md, docs/design/switch.md.
#pragma once

#include <optional>
#include <vector>

#include "chimera/manager/switch/switch_coordinator.h"
#include "chimera/runtime/plan/switch_wish.h"

namespace chimera::manager {

/// Context: setup; never blocks.
class SwitchWishes {
 public:
  /// Both outlive it.
  SwitchWishes(ManagerState& state, SwitchCoordinator& switches)
      : state_(state), switches_(switches), seen_(state.peers.n_rtpus()) {}

  /// Carries out the last request if no switch is under way and no task is being brought up. The requests before it
  /// count as handled, too.
  void look(Nanoseconds now);

 private:
  struct Open {
    RtpuId rtpu;
    std::uint32_t incarnation;
    OpenWish wish;
  };

  std::optional<Open> read(RtpuId rtpu) const noexcept;
  const Open* find_last();
  void deal_with_all() noexcept;
  void ask(SwitchRequest request, Nanoseconds now);
  void tell_refused(const std::string& what, const std::string& by, const std::string& why, Nanoseconds at);

  ManagerState& state_;
  SwitchCoordinator& switches_;
  std::vector<std::optional<Open>> seen_;  // by rtpu: not handled yet; kept even if the block has gone with its process
};

}  // namespace chimera::manager
