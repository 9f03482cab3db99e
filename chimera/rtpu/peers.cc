// SPDX-License-Identifier: Apache-2.0
// Maps the segments of other processes for one rtpu, and unmaps those that it no longer reads.
#include "chimera/rtpu/peers.h"

#include <utility>

namespace chimera {

Result<std::unique_ptr<MappedPeers>> MappedPeers::create(const ApplicationSpec& spec) {
  std::unique_ptr<MappedPeers> made(new MappedPeers);
  made->spec_ = &spec;
  for (std::uint32_t peer = 0; peer <= spec.rtpus.size(); ++peer) {
    auto layout = PeerLayout::of(spec, peer, made->memory_);
    if (!layout) return layout.error();
    made->layouts_.push_back(*layout);
    made->slots_.push_back(std::make_unique<Slot>());
  }
  return made;
}

// Of each peer: the segment in use, the one before, and an offered one.
std::uint64_t MappedPeers::room() const noexcept {
  std::uint64_t bytes = 0;
  for (const PeerLayout& each : layouts_)
    bytes += 3 * peer_segment_bytes(each.table(), static_cast<std::uint32_t>(spec_->tasks.size()));
  return bytes;
}

MappedPeers::~MappedPeers() {
  clear();
  for (const auto& slot : slots_) {
    delete slot->offered.load();
    delete slot->present;
    delete slot->previous;
  }
}

Result<void> MappedPeers::offer(std::uint32_t peer, std::uint32_t incarnation, int descriptor) {
  if (peer >= count()) return Error{ErrorCode::kBadInput, {"no such peer"}, {}};
  const auto n_tasks = static_cast<std::uint32_t>(spec_->tasks.size());
  auto segment = PeerSegment::open(descriptor, layout(peer), n_tasks, peer, incarnation);
  if (!segment) return segment.error();
  auto made = std::make_unique<Mapping>();
  made->segment = *std::move(segment);
  // SYNC: pairs with the acquire in adopt(): the mapping is complete before it is seen.
  delete slots_[peer]->offered.exchange(made.release(), std::memory_order_acq_rel);
  return {};
}

void MappedPeers::clear() {
  Mapping* at = released_.exchange(nullptr, std::memory_order_acquire);  // pairs with release_mapping()
  while (at != nullptr) delete std::exchange(at, at->next);
}

bool MappedPeers::adopt(std::uint32_t peer) noexcept {
  Slot& slot = *slots_[peer];
  if (slot.offered.load(std::memory_order_relaxed) == nullptr) return false;
  release_mapping(peer);
  slot.previous = slot.present;
  slot.present = slot.offered.exchange(nullptr, std::memory_order_acquire);  // pairs with offer()
  return true;
}

void MappedPeers::release_mapping(std::uint32_t peer) noexcept {
  Mapping* gone = std::exchange(slots_[peer]->previous, nullptr);
  if (gone == nullptr) return;
  gone->next = released_.load(std::memory_order_relaxed);
  while (!released_.compare_exchange_weak(gone->next, gone, std::memory_order_release)) {
  }
}

}  // namespace chimera
