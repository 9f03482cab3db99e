// SPDX-License-Identifier: Apache-2.0
// Switches of configurations over several real-time units in virtual time: what the manager does for processes
// (docs/formats/processes.md), without delay. The units carry a switch out by the code that processes have.
#pragma once

#include <deque>
#include <span>

#include "chimera/runtime/asked_tasks.h"
#include "chimera/runtime/hosted/heap_memory.h"
#include "chimera/runtime/switch_agreement.h"
#include "chimera/runtime/switch_peers.h"
#include "chimera/runtime/switch_way.h"
#include "chimera/runtime/switch_wish.h"
#include "chimera/runtime/virtual/virtual_peers.h"

namespace chimera {

/// One thread. Context of everything not marked: edge; no allocation.
class VirtualSwitches {
 public:
  /// Memory for the receipts of `n` switches of the rtpus that have joined `peers`, which outlives this; of more the
  /// first and the last are kept. `asked`, which outlives this, may be null where no request has lists. Context: setup.
  VirtualSwitches(VirtualPeers& peers, std::size_t n, AskedTasks* asked);
  /// What the unit knows of the others in a switch. Context: setup.
  SwitchPeers& of(RtpuId rtpu) noexcept { return members_[rtpu.index]; }
  void begin(Nanoseconds origin) noexcept { origin_ = origin; }

  /// Judges the request and orders the switch; what became of it is in receipts(). Lists that lead to no legal set have
  /// no effect. Requires: memory for a receipt.
  void ask(SwitchRequest request, Nanoseconds now) noexcept;
  /// A switch of which nothing is left to do is over; then the last wish of a task is taken up.
  void look(Nanoseconds now) noexcept;
  bool is_under_way() const noexcept { return present_ != nullptr; }
  /// Context: setup, between runs.
  const SwitchReceipts& receipts() const noexcept { return receipts_; }

 private:
  /// One unit.
  class Member final : public SwitchPeers {
   public:
    Member(VirtualSwitches& all, std::uint32_t me) noexcept : all_(all), me_(me) {}
    SwitchPage& page() noexcept override { return all_.page_; }
    std::uint16_t living() const noexcept override { return all_.living(); }
    const SwitchProgress* progress(std::uint32_t context) const noexcept override {
      return &all_.members_[context].progress_;
    }
    void ring() noexcept override { all_.ring(); }
    void show() noexcept override { all_.peers_.show_change(RtpuId(me_)); }
    void tell_adopted(std::uint16_t number) noexcept override;
    void tell_over(const SwitchReceipt& receipt) noexcept override;
    void tell_takeover(const Takeover& takeover) noexcept override { keep_receipt(takeover, all_.receipts_); }
    void wish(const SwitchRequest& request, bool changes_nothing, Nanoseconds) noexcept override {
      if (is_new_wish(request.is_for(all_.wish_), changes_nothing, static_cast<bool>(all_.wish_))) all_.wish_ = request;
    }
    bool is_wish_open() const noexcept override { return static_cast<bool>(all_.wish_); }
    bool is_over(std::uint16_t number) const noexcept { return progress_.over == number; }

   private:
    VirtualSwitches& all_;
    std::uint32_t me_;
    SwitchProgress progress_;
  };

  SwitchAgreement agreement() noexcept { return {page_, origin_}; }
  std::uint16_t living() const noexcept;
  bool leads_to(const SwitchRequest& request) const noexcept;
  Nanoseconds lead() const noexcept;
  void ring() noexcept;
  void order(Nanoseconds until) noexcept;
  SwitchWay judge_way() noexcept;
  TaskStanding standing_of(TaskId task) const noexcept;
  bool try_again(Nanoseconds now) noexcept;
  void finish(Nanoseconds now) noexcept;
  void sort_reinitialised() noexcept;
  void add_part(const SwitchReceipt& part, RtpuId rtpu) noexcept;

  VirtualPeers& peers_;
  AskedTasks* asked_;
  HeapMemory memory_;
  SwitchPage page_;
  std::deque<Member> members_;  // by rtpu
  SwitchPlanner planner_;
  SwitchWays ways_;
  SwitchPlan plan_;
  std::span<TaskStanding> standing_;  // by task, when a plan is judged
  SwitchReceipts receipts_;
  SwitchReceipt* present_ = nullptr;  // of the switch under way
  TaskBits target_;                   // that it leads to
  Nanoseconds until_;                 // its deadline
  std::size_t n_tasks_ = 0, n_variables_ = 0;  // in it
  std::uint32_t constants_ = kNoSet;           // the set whose constants are in force
  SwitchRequest wish_;  // of the task that asked last: waits for the switch that is under way to end
  Nanoseconds origin_;
};

}  // namespace chimera
