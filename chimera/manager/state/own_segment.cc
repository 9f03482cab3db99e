// SPDX-License-Identifier: Apache-2.0
// Makes the manager's segment, or takes over what its predecessor left in one.
#include "chimera/manager/state/own_segment.h"

#include <algorithm>

#include "chimera/manager/state/switch_journal.h"

namespace chimera::manager {
namespace {

// Copies from a dead predecessor into a block that no process reads yet: relaxed, pairs with nothing.
template <class T>
void copy_word(std::atomic<T>& to, const std::atomic<T>& from) noexcept {
  to.store(from.load(std::memory_order_relaxed), std::memory_order_relaxed);
}

}  // namespace

Result<OwnSegment> OwnSegment::make(const Peers& peers, std::uint32_t incarnation, const PeerSegment* predecessor,
                                    Nanoseconds now) {
  const PeerLayout& layout = peers.manager_layout();
  auto region = MemoryRegion::create("chimera-manager", peer_segment_bytes(layout.table(), peers.n_tasks()));
  if (!region) return region.error();
  OwnSegment made(layout, *std::move(region), incarnation);
  made.peer_ = peers.n_rtpus();
  const auto table = SegmentOwner::format(made.region_.writable(), layout.table());
  if (!table) return table.error();
  made.block_ = BlockOwner(made.region_.writable().data() + block_offset(layout.table()), made.peer_, incarnation,
                           peers.n_tasks(), peers.n_rtpus() + 1);
  for (std::size_t i = 0; i < peers.spec().operators.size(); ++i) {
    made.operators_.push_back(table->writer(made.link(i)));
    std::vector<std::byte> value(made.operators_[i].payload_bytes());
    chimera_slot left;
    if (predecessor != nullptr && predecessor->group(layout.operator_group(i)).try_read(left, value.data()) &&
        left.sequence > 0)
      made.operators_[i].write(value.data(), Nanoseconds{left.published_ns}, 1);
    else
      made.publish_operator(i, peers.spec().operators[i].value, now);
  }
  if (predecessor != nullptr) made.take_over(predecessor->block(), peers);
  made.block_.head().phase.store(PeerPhase::kServing, std::memory_order_release);
  return made;
}

void OwnSegment::take_over(const BlockView& left, const Peers& peers) noexcept {
  for (std::uint32_t t = 0; t < peers.n_tasks(); ++t) {
    block_.set_goal(TaskId(t), left.goal(TaskId(t)));
    block_.set_status(TaskId(t), left.status(TaskId(t)));
  }
  block_.head().flag = left.head().flag & kOperatorFlag;
  SwitchJournal(block_.journal()).take_over(left.journal());
  const ManagerMemory& from = left.memory();
  ManagerMemory& to = block_.memory();
  const std::uint64_t last = LineJournal(block_.event_journal()).take_over(left.event_journal());
  to.events.store(std::max(last, from.events.load(std::memory_order_relaxed)), std::memory_order_relaxed);
  copy_word(to.started, from.started);
  copy_word(to.started_at, from.started_at);
  for (std::uint32_t r = 0; r < kMaxRtpus; ++r) {
    copy_word(to.handled[r], from.handled[r]);
    copy_word(to.wishes[r], from.wishes[r]);
    copy_word(to.takeovers[r], from.takeovers[r]);
    copy_word(block_.progress(r).word, left.progress(r).word);
    for (std::size_t i = 0; i < 4; ++i) copy_word(to.restarts[r][i], from.restarts[r][i]);
  }
}

Link OwnSegment::link(std::size_t index) const noexcept {
  return SegmentView::planned(layout_->table(), layout_->operator_group(index), 0);
}

GroupReader OwnSegment::operator_reader(std::size_t index) const noexcept {
  return GroupReader(region_.bytes().data() + link(index).offset, link(index).payload_bytes);
}

void OwnSegment::publish_operator(std::size_t index, std::span<const std::byte> value, Nanoseconds now) noexcept {
  std::vector<std::byte> payload(operators_[index].payload_bytes());
  std::copy(value.begin(), value.begin() + std::min(value.size(), payload.size()), payload.begin());
  operators_[index].write(payload.data(), now, 1);
}

}  // namespace chimera::manager
