// SPDX-License-Identifier: Apache-2.0
// Orders the switches of all contexts in one process without delay, keeps their receipts, and shows each context the
// others. A context that is alone has one instance (runtime/cycle/releases.h); the rtpus of virtual time share one
// (runtime/virtual/virtual_rtpus.cc). For processes the manager orders switches: manager/switch/switch_coordinator.h.
#pragma once

#include <cstdint>
#include <span>

#include "chimera/runtime/life/task_set.h"
#include "chimera/runtime/plan/switch_request.h"
#include "chimera/runtime/plan/switch_wish.h"
#include "chimera/runtime/switch/switch_orders.h"
#include "chimera/runtime/switch/switch_peers.h"

namespace chimera {

/// One thread. Context of everything not marked: cycle boundary; no allocation.
class LocalSwitches : private SwitchMembers {
 public:
  LocalSwitches() noexcept : orders_(*this) {}
  LocalSwitches(const LocalSwitches&) = delete;
  LocalSwitches& operator=(const LocalSwitches&) = delete;

  /// Takes memory for `n_contexts` and for `n_receipts` receipts, above 0. Of more switches the first receipts and the
  /// last one are kept. `asked` may be null if no request has lists. What is given outlives this. Context: setup.
  void prepare(const ApplicationSpec& spec, std::uint32_t n_contexts, std::size_t n_receipts, AskedTasks* asked,
               SetupMemory& memory);
  /// `needs_gaps`: as SwitchMembers::needs_gaps() of its tasks. The tasks outlive this. Context: setup.
  void join(std::uint32_t context, TaskSet& tasks, bool needs_gaps);
  /// The reader, which outlives this, takes all receipts; room for one is enough then. Context: setup.
  void read_by(ReceiptReader& reader) noexcept { reader_ = &reader; }
  /// The view that the context has of the others in a switch. Context: setup.
  SwitchPeers& of(std::uint32_t context) noexcept { return members_[context]; }
  void begin(Nanoseconds origin) noexcept { orders_.begin(origin); }
  /// The context takes part in nothing any more.
  void die(std::uint32_t context) noexcept;

  /// The script, which stands for a person, sends the signal: `off` and `kill` keep the task OFF until its `on`.
  void note_word(TaskId task, Signal signal) noexcept;
  bool is_kept_off(TaskId task) const noexcept override { return kept_off_.has(task); }
  /// Judges the request and orders the switch; its receipt is in receipts(). Lists that lead to no legal set have no
  /// effect.
  void ask(SwitchRequest request, Nanoseconds now) noexcept;
  /// Ends or tries again the switch that all contexts are over with, then accepts the last request of a task. True: a
  /// plan was announced.
  bool look(Nanoseconds now) noexcept;
  /// The run is over, and the contexts have ended: a switch that is under way ends.
  void end(Nanoseconds now) noexcept;
  bool is_under_way() const noexcept { return receipt_ != nullptr; }
  SwitchReceipts& receipts() noexcept { return receipts_; }

 protected:
  /// A word of the page changed.
  void ring() noexcept override {}
  /// Shows the changes of the context to the others.
  virtual void show(std::uint32_t /*context*/) noexcept {}

 private:
  struct Member final : SwitchPeers {
    SwitchPage& page() noexcept override { return all->page_; }
    std::uint16_t living() const noexcept override { return all->living(); }
    const SwitchProgress* progress(std::uint32_t context) const noexcept override {
      return &all->members_[context].shown;
    }
    void ring() noexcept override { all->ring(); }
    void show() noexcept override { all->show(me); }
    void tell_adopted(std::uint16_t number) noexcept override;
    void tell_over(const SwitchReceipt& receipt) noexcept override;
    void tell_takeover(const Takeover& takeover) noexcept override { keep_receipt(takeover, all->receipts_); }
    void wish(const SwitchRequest& request, bool changes_nothing, Nanoseconds now) noexcept override;
    bool is_wish_open() const noexcept override { return static_cast<bool>(all->wish_); }

    LocalSwitches* all = nullptr;
    std::uint32_t me = 0;
    TaskSet* tasks = nullptr;  // null: no task is in this context
    bool needs_gaps = true, is_dead = false;
    SwitchProgress shown;
    const SwitchReceipt* part = nullptr;  // of the last plan, until the context takes up another one
  };

  SwitchPage& page() noexcept override { return page_; }
  std::uint16_t living() const noexcept override;
  TaskStatus status(TaskId task) const noexcept override;
  Profile profile(TaskId task) const noexcept override;
  bool needs_gaps(TaskId task) const noexcept override { return member_of(task).needs_gaps; }
  const MadeConstants& constants() noexcept override;
  bool is_busy_with(std::uint32_t context, std::uint16_t plan) const noexcept override;
  bool read_part(std::uint32_t context, std::uint16_t plan, SwitchReceipt& part) const noexcept override;

  const Member& member_of(TaskId task) const noexcept;
  void note_word(const TaskBits& on, const TaskBits& off) noexcept;
  bool find_target(SwitchRequest& request, Nanoseconds now, TaskBits& target) noexcept;
  void end_if_over(Nanoseconds now, bool is_run_over) noexcept;

  SwitchOrders orders_;
  SwitchPage page_;
  const ApplicationSpec* spec_ = nullptr;
  AskedTasks* asked_ = nullptr;
  std::span<Member> members_;  // by context
  SwitchReceipts receipts_;
  OrderedSwitch present_;
  ReceiptReader* reader_ = nullptr;
  SwitchReceipt* receipt_ = nullptr;  // of the switch that is under way
  SwitchRequest wish_;                // of the task that asked last: waits for the end of the switch that is under way
  TaskBits kept_off_;                 // by the script
  Nanoseconds latest_;                // instant of the last part
};

}  // namespace chimera
