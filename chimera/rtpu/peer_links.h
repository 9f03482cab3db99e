// SPDX-License-Identifier: Apache-2.0
// What the tasks of a real-time unit know of the other processes, through their mapped segments, and what they let
// them know through the unit's own. docs/formats/processes.md.
#pragma once

#include <span>
#include <vector>

#include "chimera/platform/wake.h"
#include "chimera/rtpu/group_claims.h"
#include "chimera/rtpu/peers.h"
#include "chimera/runtime/peer_view.h"
#include "chimera/runtime/task_set.h"

namespace chimera {

/// Used by the thread that cycles only. Everything given to it outlives it.
class PeerLinks final : public PeerView {
 public:
  /// `segment` is the unit's own, writable; `block` lies in it.
  PeerLinks(const ApplicationSpec& spec, std::uint32_t me, std::span<std::byte> segment, BlockOwner block,
            DecisionPage& decision, const KeeperPage& keeper, MappedPeers& peers);
  /// Shows the others what is listed in tasks.changes() and clears the list: for each change, in order, the word or the
  /// fault group and then the event for the manager's log; after the last of them all bells are rung, once.
  /// Context: cycle boundary; wait-free.
  void publish(TaskSet& tasks) noexcept;
  /// publish() of every task whose shown state is not its own, listed or not: at the start. Context: cycle boundary.
  void publish_all(TaskSet& tasks) noexcept;
  /// While it keeps them nobody is shown states: what was ON when the unit began to end alone comes back with its
  /// successor. When it does not any more, all are shown. Context: cycle boundary.
  void keep_last_words(bool keeps, TaskSet& tasks) noexcept;
  bool keeps_last_words() const noexcept { return keeps_last_words_; }

  State state(TaskId task) const noexcept override;
  PeerPresence presence(TaskId task) const noexcept override;
  GroupReader outputs(TaskId task) const noexcept override;
  GroupReader constants(TaskId task) const noexcept override;
  GroupReader operator_variable(std::size_t index) const noexcept override;
  bool post(Signal signal, TaskId target, TaskId from, bool is_echo) noexcept override;
  bool claim(std::size_t group) noexcept override { return !keeps_last_words_ && claims_.take(group); }

  /// Takes over segments that the main thread offered; true when there was one. One that follows another waits until
  /// no task reads that any more. `now`: of the cycle boundary; events of flags and notes are stamped with it. Context:
  /// cycle boundary.
  bool adopt(TaskSet& tasks, Nanoseconds now) noexcept;
  /// From here on `flag` reads the flag words of those who live; that of the manager also while it is being restarted.
  /// Context: cycle boundary.
  void watch_flags(IllegalFlag& flag) noexcept;
  /// The next post of any peer. Context: cycle boundary; wait-free.
  bool pop(Post& post) noexcept;
  /// To the manager; what finds no room is counted. Context: cycle boundary; wait-free.
  void send(const Post& post) noexcept;
  /// An event for the manager's log.
  void send_event(EventKind happening, TaskId task, std::uint64_t detail, Nanoseconds at) noexcept;
  /// The count of changes of the decision page. Context: cycle; wait-free.
  std::uint32_t changes() const noexcept { return decision_->changes.load(std::memory_order_acquire); }
  /// Does the manager want the task's publications on the tap? Not while there is no manager. Context: cycle boundary;
  /// wait-free.
  bool is_wanted_on_tap(TaskId task) const noexcept {
    const PeerSegment* there = peers_->at(manager());
    return there != nullptr && there->block().is_tapped(task);
  }
  /// The segment of a peer that lives; null: it does not, or was not adopted yet. Context: cycle boundary; wait-free.
  const PeerSegment* at(std::uint32_t peer) const noexcept;
  /// All are to look: at status words, and at the words of a switch. Context: cycle boundary; wait-free.
  void ring_all() noexcept;
  std::uint32_t manager() const noexcept { return static_cast<std::uint32_t>(spec_->rtpus.size()); }
  const BlockOwner& block() const noexcept { return block_; }

 private:
  void let_go_unread(const Sources& sources) noexcept;
  bool publish_status(const Task& task, TaskStatus before, TaskStatus now) noexcept;
  bool publish_flag(const IllegalFlag& flag) noexcept;
  void publish_fault(const Task& task) noexcept;
  void ring(std::uint32_t peer) noexcept { Doorbell(decision_->bells[peer].word).ring(); }

  const ApplicationSpec* spec_;
  std::uint32_t me_;
  std::span<std::byte> segment_;
  BlockOwner block_;
  DecisionPage* decision_;
  std::uint32_t last_shown_ = 0;  // the count of changes with the last of this context
  const KeeperPage* keeper_;
  Nanoseconds now_;
  MappedPeers* peers_;
  bool keeps_last_words_ = false;
  GroupClaims claims_;
  std::vector<std::uint64_t> faults_, notes_;  // by task: of those that were told
  std::vector<Outbox> outboxes_;               // by peer
  std::vector<Inbox> inboxes_;                 // by peer
  std::vector<bool> is_read_;                  // by peer: a task may still read the segment before the present one
  std::vector<const std::atomic<std::uint32_t>*> flags_;  // BlockHead::flag of those who live
};

}  // namespace chimera
