// SPDX-License-Identifier: Apache-2.0
// What tasks and reactions of the real-time units have asked for: the manager finds it as words in their blocks, has
// the last of all carried out as a switch, and remembers which it has dealt with. A manager that follows another one
// finds what is open. docs/formats/processes.md, docs/design/switch.md.
#pragma once

#include <optional>
#include <vector>

#include "chimera/manager/switch_coordinator.h"
#include "chimera/runtime/switch/switch_wish.h"

namespace chimera::manager {

/// Context: setup; never blocks.
class SwitchWishes {
 public:
  /// Both outlive it.
  SwitchWishes(ManagerState& world, SwitchCoordinator& switches)
      : world_(world), switches_(switches), seen_(world.peers.n_rtpus()) {}

  /// Takes up the wish that was made last, when no switch is under way and no task is being brought up; those that were
  /// made before it are dealt with by that, too.
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

  ManagerState& world_;
  SwitchCoordinator& switches_;
  std::vector<std::optional<Open>> seen_;  // by rtpu: not dealt with; also when its block has gone with its process
};

}  // namespace chimera::manager
