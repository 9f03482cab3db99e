// SPDX-License-Identifier: Apache-2.0
// The links of an rtpu in a switch that end in the middle of an edge, as by SIGKILL: from then on no call of the rtpu
// reaches a peer. A callback runs before and after each call of the rtpu to its peers.
#pragma once

#include <functional>

#include "chimera/rtpu/switch_links.h"

namespace chimera::switching_trial {

class CutLinks final : public SwitchPeers {
 public:
  /// Both outlive it.
  CutLinks(SwitchPeers& links, std::function<void()> told) : links_(links), told_(std::move(told)) {}
  void cut() noexcept {
    if (is_cut_) return;
    is_cut_ = true;
    const SwitchPage& page = links_.page();
    nowhere_.plan = page.plan.load();
    nowhere_.turn = page.turn.load();
    for (std::size_t i = 0; i <= SwitchPage::kOrderWords; ++i) nowhere_.order[i] = page.order[i].load();
  }
  bool is_cut() const noexcept { return is_cut_; }

  SwitchPage& page() noexcept override { return is_cut_ ? nowhere_ : links_.page(); }
  std::uint16_t living() const noexcept override { return links_.living(); }
  const SwitchProgress* progress(std::uint32_t context) const noexcept override { return links_.progress(context); }
  void ring() noexcept override {
    tell([this] { links_.ring(); });
  }
  void show() noexcept override {
    tell([this] { links_.show(); });
  }
  void tell_adopted(std::uint16_t number) noexcept override {
    tell([this, number] { links_.tell_adopted(number); });
  }
  void tell_over(const SwitchReceipt& receipt) noexcept override {
    tell([this, &receipt] { links_.tell_over(receipt); });
  }
  void tell_takeover(const Takeover& takeover) noexcept override {
    tell([&] { links_.tell_takeover(takeover); });
  }
  void wish(const SwitchRequest& request, bool changes_nothing, Nanoseconds now) noexcept override {
    tell([&] { links_.wish(request, changes_nothing, now); });
  }
  bool is_wish_open() const noexcept override { return links_.is_wish_open(); }

 private:
  template <class Call>
  void tell(Call call) {
    if (is_cut_) return;
    told_();
    if (is_cut_) return;
    call();
    told_();
  }

  SwitchPeers& links_;
  std::function<void()> told_;
  SwitchPage nowhere_;
  bool is_cut_ = false;
};

}  // namespace chimera::switching_trial
