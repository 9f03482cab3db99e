// SPDX-License-Identifier: Apache-2.0
// The switches of several rtpus in virtual time, ordered without delay as the manager orders those of processes.
#pragma once

#include "chimera/runtime/switch/local_switches.h"
#include "chimera/runtime/virtual/virtual_peers.h"

namespace chimera {

/// One context for each rtpu, with its number. Contexts as LocalSwitches.
class VirtualSwitches final : public LocalSwitches {
 public:
  /// Outlived by the peers. Context: setup.
  explicit VirtualSwitches(VirtualPeers& peers) noexcept : peers_(peers) {}

 private:
  void ring() noexcept override {
    for (std::uint32_t r = 0; r < peers_.spec().rtpus.size(); ++r) peers_.ring(RtpuId(r));
  }
  void show(std::uint32_t context) noexcept override { peers_.show_change(RtpuId(context)); }

  VirtualPeers& peers_;
};

}  // namespace chimera
