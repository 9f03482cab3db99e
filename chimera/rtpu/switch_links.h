// SPDX-License-Identifier: Apache-2.0
// State of the other rtpus in a switch, and of this one for them: words of the decision page and of the blocks. An rtpu
// that ends alone (PeerLinks::keep_last_words) takes part in no switch: it sees a page without a plan, and its words
// stay as they are. So the others and the manager find what a SIGKILL would have left. docs/formats/processes.md.
#pragma once

#include "chimera/rtpu/peer_links.h"
#include "chimera/runtime/switch/switch_peers.h"

namespace chimera {

/// Only the cycling thread uses it. All its arguments outlive it.
class SwitchLinks final : public SwitchPeers {
 public:
  SwitchLinks(TaskSet& tasks, PeerLinks& others, const MappedPeers& mapped, DecisionPage& decision,
              std::uint32_t me) noexcept
      : tasks_(tasks), others_(others), mapped_(mapped), decision_(decision), me_(me) {}

  SwitchPage& page() noexcept override { return others_.keeps_last_words() ? no_plan_ : decision_.switching; }
  std::uint16_t living() const noexcept override;
  const SwitchProgress* progress(std::uint32_t context) const noexcept override;
  void ring() noexcept override { others_.ring_all(); }
  void show() noexcept override { others_.publish(tasks_); }
  void tell_adopted(std::uint16_t number) noexcept override;
  void tell_over(const SwitchReceipt& receipt) noexcept override;
  void tell_takeover(const Takeover& takeover) noexcept override;
  void wish(const SwitchRequest& request, bool changes_nothing, Nanoseconds now) noexcept override;
  bool is_wish_open() const noexcept override;

 private:
  bool was_dealt_with(const BlockHead& head, std::uint32_t rtpu, std::uint16_t wish) const noexcept;
  TaskSet& tasks_;
  PeerLinks& others_;
  const MappedPeers& mapped_;
  DecisionPage& decision_;
  SwitchPage no_plan_;
  std::uint32_t me_;
};

}  // namespace chimera
