// SPDX-License-Identifier: Apache-2.0
// For tests: an rtpu as the manager sees it, played by a thread. It has a segment and a block, serves signals by the
// table of the state machine, and publishes a count in its cycles.
#pragma once

#include <gtest/gtest.h>

#include <atomic>
#include <cstring>
#include <map>
#include <mutex>
#include <optional>
#include <thread>
#include <vector>

#include "chimera/manager/state/peers.h"
#include "chimera/platform/clock.h"
#include "chimera/platform/descriptor.h"
#include "chimera/platform/wake.h"
#include "chimera/runtime/hosted/heap_memory.h"
#include "chimera/task/fault_record.h"

namespace chimera::manager {

/// Answers every method with ok. Its thread ends with die(); the segment stays.
class FakeRtpu {
 public:
  FakeRtpu(const ApplicationSpec& spec, std::uint32_t peer, std::uint32_t incarnation, DecisionPage& page)
      : spec_(spec), layout_(*PeerLayout::of(spec, peer, heap_)),
        manager_layout_(*PeerLayout::of(spec, manager(), heap_)), page_(page), peer_(peer), incarnation_(incarnation) {
    const auto tasks = static_cast<std::uint32_t>(spec.tasks.size());
    region_ = *MemoryRegion::create("fake-rtpu", peer_segment_bytes(layout_.table(), tasks));
    const auto table = SegmentOwner::format(region_.writable(), layout_.table());
    EXPECT_TRUE(table);
    block_ = BlockOwner(region_.writable().data() + block_offset(layout_.table()), peer, incarnation, tasks,
                        manager() + 1);
    tap_.emplace(block_.tap());
    std::strcpy(block_.head().grant, "as an ordinary process");
    for (std::uint32_t t = 0; t < tasks; ++t) {
      if (!layout_.has(TaskId(t))) continue;
      for (std::uint32_t half : {0u, 1u}) writers_.push_back(writer(*table, layout_.outputs(TaskId(t), half)));
      faults_.push_back(writer(*table, layout_.fault(TaskId(t))));
      mine_.push_back(TaskId(t));
    }
    block_.head().phase = PeerPhase::kServing;
    thread_ = std::thread([this] { serve(); });
  }
  ~FakeRtpu() { die(); }
  FakeRtpu(const FakeRtpu&) = delete;

  int descriptor() const noexcept { return region_.descriptor(); }
  std::uint32_t incarnation() const noexcept { return incarnation_; }
  const BlockOwner& block() const noexcept { return block_; }
  std::uint32_t manager() const noexcept { return static_cast<std::uint32_t>(spec_.rtpus.size()); }
  /// Maps a manager's segment; takes ownership of the descriptor.
  void meet(int descriptor, std::uint32_t incarnation) {
    const OwnedDescriptor passed(descriptor);
    auto segment = PeerSegment::open(descriptor, manager_layout_, tasks(), manager(), incarnation);
    ASSERT_TRUE(segment) << segment.error().message.c_str();
    const std::scoped_lock lock(mutex_);
    manager_ = *std::move(segment);
    inbox_ = Inbox(manager_.block().outbox(peer_), block_.progress(manager()), incarnation);
    outbox_ = Outbox(block_.outbox(manager()), &manager_.block().progress(peer_), incarnation_);
    ring();
  }
  /// Acts as if the task's method failed: its words, the state, the event.
  void fail(TaskId task, const char* text) {
    const std::scoped_lock lock(mutex_);
    FaultRecord record;
    record.count = 1;
    record.at = clock_.now();
    record.method = Method::kCycle;
    std::strncpy(record.last.text, text, sizeof record.last.text - 1);
    std::vector<std::byte> payload(layout_.place(layout_.fault(task)).payload_bytes);
    std::memcpy(payload.data(), &record, sizeof record);
    faults_[index(task)].write(payload.data(), record.at, 1);
    Post post = about(task, PostKind::kEvent);
    post.happening = EventKind::kFault;
    post.detail = CHIMERA_CYCLE;
    tell(post);
    enter(task, State::kError);
  }
  /// Acts as if a method of the task had left a note.
  void leave_note(TaskId task, const char* text) {
    const std::scoped_lock lock(mutex_);
    FaultRecord record;
    record.notes = 1;
    std::strncpy(record.note, text, sizeof record.note - 1);
    std::vector<std::byte> payload(layout_.place(layout_.fault(task)).payload_bytes);
    std::memcpy(payload.data(), &record, sizeof record);
    faults_[index(task)].write(payload.data(), clock_.now(), 1);
    Post post = about(task, PostKind::kEvent);
    post.happening = EventKind::kNote;
    tell(post);
  }
  /// Number of rings of the doorbells of its tasks.
  std::atomic<int> rings{0};
  /// Value of every byte that its tasks publish; below 0: they count.
  std::atomic<int> filled_with{-1};
  /// Serves no signal until set again.
  std::atomic<bool> is_deaf{false};

  /// Ends the rtpu after it has overwritten its memory: `word` at every 64th byte, or at every 8th. Its header, too.
  void die_overwritten(std::uint64_t word, std::size_t every = 64) {
    die();
    const std::span<std::byte> bytes = region_.writable();
    for (std::size_t at = 0; at + sizeof word <= bytes.size(); at += every) {
      std::memcpy(bytes.data() + at, &word, sizeof word);
      word = word * 2862933555777941757u + 3037000493u;
    }
  }

  void die() {
    stop_ = true;
    Doorbell(page_.bells[peer_].word).ring();
    if (thread_.joinable()) thread_.join();
  }

 private:
  std::uint32_t tasks() const noexcept { return static_cast<std::uint32_t>(spec_.tasks.size()); }
  GroupWriter writer(const SegmentOwner& table, GroupId group) const {
    return table.writer(SegmentView::planned(layout_.table(), group, 0));
  }
  std::size_t index(TaskId task) const {
    for (std::size_t i = 0; i < mine_.size(); ++i)
      if (mine_[i] == task) return i;
    ADD_FAILURE() << "a signal for a task of another rtpu";
    return 0;
  }
  Post about(TaskId task, PostKind kind) {
    Post post;
    post.kind = kind;
    post.task = task;
    post.at = clock_.now();
    return post;
  }
  void tell(const Post& post) {
    if (!outbox_.try_post(post)) ++block_.head().lost_posts;
    ring();
  }
  void ring() {
    ++page_.changes;
    for (std::uint32_t p = 0; p <= manager(); ++p) Doorbell(page_.bells[p].word).ring();
  }

  void serve() {
    while (!stop_) {
      const Doorbell bell(page_.bells[peer_].word);
      const std::uint32_t seen = bell.read();
      {
        const std::scoped_lock lock(mutex_);
        for (Post post; !is_deaf && inbox_.take(post);) {
          if (post.signal == Signal::kWakeup) ++rings;
          else step_.push_back(post);
          if (!step_.empty() && !post.more) carry_out();
        }
        for (const TaskId task : mine_)
          if (block_.view().status(task).state == State::kOn) cycle(task);
        ++block_.head().beats;
      }
      bell.wait_until(seen, clock_.now() + milliseconds(1));
    }
  }

  void carry_out() {
    std::size_t bad = step_.size();
    for (std::size_t i = 0; i < step_.size(); ++i)
      if (after(step_[i]) == State::kError) bad = std::min(bad, i);
    for (std::size_t i = 0; i < step_.size(); ++i) {
      Post report = about(step_[i].task, PostKind::kReport);
      report.command = step_[i].command;
      report.signal = step_[i].signal;
      report.before = report.after = block_.view().status(report.task).state;
      report.why = static_cast<std::uint8_t>(i == bad ? Refusal::kState : Refusal::kNone);
      report.detail = bad == step_.size() ? 1 : 0;
      if (bad == step_.size()) enter(report.task, report.after = after(step_[i]));
      if (report.command != 0) tell(report);
    }
    step_.clear();
  }
  /// The state to which the signal leads; ERROR if the signal is not legal. No legal signal leads to ERROR here.
  State after(const Post& post) const {
    Next at = next(block_.view().status(post.task).state, post.signal, false);
    while (at.kind == Next::Kind::kStep) at = rule(at.step).next[0];
    return at.kind == Next::Kind::kState ? at.state : State::kError;
  }
  void enter(TaskId task, State state) {
    TaskStatus status = block_.view().status(task);
    Post post = about(task, PostKind::kEvent);
    post.happening = EventKind::kState;
    post.before = status.state;
    post.after = status.state;
    if (status.state == State::kNotCreated) ++status.incarnation;
    status.state = post.after = state;
    block_.set_status(task, status);
    tell(post);
  }
  void cycle(TaskId task) {
    GroupWriter& out = writers_[2 * index(task) + block_.view().status(task).incarnation % 2];
    Profile& profile = block_.profile(task);
    profile.execution[CHIMERA_CYCLE].add(microseconds(3));
    ++profile.cycles;
    std::vector<std::byte> payload(out.payload_bytes());
    const auto count = static_cast<double>(profile.cycles);
    for (std::size_t at = 0; at + sizeof count <= payload.size(); at += sizeof count)
      std::memcpy(payload.data() + at, &count, sizeof count);
    const int byte = filled_with;
    if (byte >= 0) std::memset(payload.data(), byte, payload.size());
    out.write(payload.data(), clock_.now(), ~std::uint64_t{0});
    tap_->append({.at = clock_.now(), .a = CHIMERA_CYCLE, .task = task, .kind = TapKind::kRun});
    if (profile.cycles % 8 == 0) tap_->append({.at = clock_.now(), .b = 5000, .task = task, .kind = TapKind::kOverrun});
    if (!manager_.is_there() || !manager_.block().is_tapped(task)) return;
    std::vector<std::byte> slot(sizeof(chimera_slot) + payload.size());
    const chimera_slot header{clock_.now().count, profile.cycles, ~std::uint64_t{0}, 0};
    std::memcpy(slot.data(), &header, sizeof header);
    std::memcpy(slot.data() + sizeof header, payload.data(), payload.size());
    tap_->append_row(*reinterpret_cast<const chimera_slot*>(slot.data()), out.payload_bytes(), task,
                    static_cast<std::uint8_t>(peer_), rows_[index(task)]++);
  }

  const ApplicationSpec& spec_;
  HeapMemory heap_;
  PeerLayout layout_, manager_layout_;
  DecisionPage& page_;
  std::uint32_t peer_, incarnation_;
  LinuxClock clock_;
  MemoryRegion region_;
  BlockOwner block_;
  std::optional<Tap> tap_;
  std::map<std::size_t, std::uint32_t> rows_;
  std::vector<GroupWriter> writers_, faults_;
  std::vector<TaskId> mine_;
  std::mutex mutex_;
  PeerSegment manager_;
  Inbox inbox_;
  Outbox outbox_;
  std::vector<Post> step_;
  std::atomic<bool> stop_{false};
  std::thread thread_;
};

}  // namespace chimera::manager
