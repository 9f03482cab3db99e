// SPDX-License-Identifier: Apache-2.0
// What the tasks of an rtpu read of other processes, through their mapped segments, and publish through the segment of
// the rtpu. docs/formats/processes.md.
#pragma once

#include <span>
#include <vector>

#include "chimera/platform/wake.h"
#include "chimera/rtpu/group_claims.h"
#include "chimera/rtpu/peers.h"
#include "chimera/runtime/life/task_set.h"
#include "chimera/runtime/state/peer_view.h"

namespace chimera {

/// Only the cycling thread uses it. All its arguments outlive it.
class PeerLinks final : public PeerView {
 public:
  /// `segment` is the rtpu's own, writable; `block` lies in it.
  PeerLinks(const ApplicationSpec& spec, std::uint32_t me, std::span<std::byte> segment, BlockOwner block,
            DecisionPage& decision, const KeeperPage& keeper, MappedPeers& peers);
  /// Publishes the changes in tasks.changes() and clears the list. For each change, in order, it writes the word or the
  /// fault group, then the event for the manager's log. At the end it rings all bells once. Context: cycle boundary;
  /// wait-free.
  void publish(TaskSet& tasks) noexcept;
  /// publish() for every task whose published state is not its own, listed or not: at the start. Context: cycle
  /// boundary.
  void publish_all(TaskSet& tasks) noexcept;
  /// While `keeps` is true, publishes no states: the tasks that were ON when the rtpu began to end alone come back with
  /// its successor. When it becomes false, publishes all states. Context: cycle boundary.
  void keep_last_words(bool keeps, TaskSet& tasks) noexcept;
  bool keeps_last_words() const noexcept { return keeps_last_words_; }

  State state(TaskId task) const noexcept override;
  PeerPresence presence(TaskId task) const noexcept override;
  GroupReader outputs(TaskId task) const noexcept override;
  GroupReader constants(TaskId task) const noexcept override;
  GroupReader operator_variable(std::size_t index) const noexcept override;
  bool post(Signal signal, TaskId target, TaskId from, bool is_echo) noexcept override;
  bool claim(std::size_t group) noexcept override { return !keeps_last_words_ && claims_.take(group); }

  /// Starts to use segments that the main thread offered; true if there was one. The next segment of a peer waits until
  /// no task reads the one before the present one. `now`: time of the cycle boundary, for events of flags and notes.
  /// Context: cycle boundary.
  bool adopt(TaskSet& tasks, Nanoseconds now) noexcept;
  /// From here on `flag` reads the flag words of the live peers. It keeps reading the manager's word while the manager
  /// is restarted. Context: cycle boundary.
  void watch_flags(IllegalFlag& flag) noexcept;
  /// Reads the next post of any peer. Context: cycle boundary; wait-free.
  bool pop(Post& post) noexcept;
  /// Sends a post to the manager; counts posts that find no room. Context: cycle boundary; wait-free.
  void send(const Post& post) noexcept;
  /// An event for the manager's log.
  void send_event(EventKind happening, TaskId task, std::uint64_t detail, Nanoseconds at) noexcept;
  /// The count of changes of the decision page. Context: cycle; wait-free.
  std::uint32_t changes() const noexcept { return decision_->changes.load(std::memory_order_acquire); }
  /// True if the manager wants the task's publications on the tap. False while there is no manager. Context: cycle
  /// boundary; wait-free.
  bool is_wanted_on_tap(TaskId task) const noexcept {
    const PeerSegment* there = peers_->at(manager());
    return there != nullptr && there->block().is_tapped(task);
  }
  /// Segment of a live peer; nullptr if it is dead or not adopted yet. Context: cycle boundary; wait-free.
  const PeerSegment* at(std::uint32_t peer) const noexcept;
  /// Rings all peers, so that they read status words and the words of a switch. Context: cycle boundary; wait-free.
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
  std::uint32_t last_shown_ = 0;  // the count of changes after the last change of this rtpu
  const KeeperPage* keeper_;
  Nanoseconds now_;
  MappedPeers* peers_;
  bool keeps_last_words_ = false;
  GroupClaims claims_;
  std::vector<std::uint64_t> faults_, notes_;  // by task: counts that were published last
  std::vector<Outbox> outboxes_;               // by peer
  std::vector<Inbox> inboxes_;                 // by peer
  std::vector<bool> is_read_;                  // by peer: a task may still read the segment before the present one
  std::vector<const std::atomic<std::uint32_t>*> flags_;  // BlockHead::flag of the live peers
};

}  // namespace chimera
