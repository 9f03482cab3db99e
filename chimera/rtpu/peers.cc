// SPDX-License-Identifier: Apache-2.0
#include "chimera/rtpu/peers.h"

#include <new>
#include <utility>

namespace chimera {

Result<std::unique_ptr<Peers>> Peers::create(const ApplicationSpec& spec) {
  std::unique_ptr<Peers> made(new Peers);
  made->spec_ = &spec;
  for (std::uint32_t peer = 0; peer <= spec.rtpus.size(); ++peer) {
    auto layout = PeerLayout::of(spec, peer);
    if (!layout) return layout.error();
    made->layouts_.push_back(std::make_unique<PeerLayout>(*std::move(layout)));
    made->slots_.push_back(std::make_unique<Slot>());
  }
  return made;
}

Peers::~Peers() {
  clear();
  for (const auto& slot : slots_) {
    delete slot->offered.load();
    delete slot->present;
    delete slot->previous;
  }
}

Result<void> Peers::offer(std::uint32_t peer, std::uint32_t incarnation, int descriptor) {
  if (peer >= count()) return Error{ErrorCode::kBadInput, {"no such peer"}, {}};
  const auto n_tasks = static_cast<std::uint32_t>(spec_->tasks.size());
  const TableLayout& table = layout(peer).table();
  auto region = MemoryRegion::open_read_only(descriptor, peer_segment_bytes(table, n_tasks));
  if (!region) return region.error();
  if (const auto view = SegmentView::open(region->bytes(), table.hash()); !view) return view.error();
  auto made = std::make_unique<MappedPeer>();
  made->incarnation = incarnation;
  made->block = BlockView(region->bytes().data() + block_offset(table), n_tasks);
  made->region = *std::move(region);
  // SYNC: pairs with the acquire in adopt(): the mapping is whole before it is seen.
  delete slots_[peer]->offered.exchange(made.release(), std::memory_order_acq_rel);
  return {};
}

void Peers::clear() {
  MappedPeer* at = released_.exchange(nullptr, std::memory_order_acquire);  // pairs with let_go()
  while (at != nullptr) delete std::exchange(at, at->next);
}

bool Peers::adopt(std::uint32_t peer) noexcept {
  Slot& slot = *slots_[peer];
  if (slot.offered.load(std::memory_order_relaxed) == nullptr) return false;
  let_go(peer);
  slot.previous = slot.present;
  slot.present = slot.offered.exchange(nullptr, std::memory_order_acquire);  // pairs with offer()
  return true;
}

void Peers::let_go(std::uint32_t peer) noexcept {
  MappedPeer* gone = std::exchange(slots_[peer]->previous, nullptr);
  if (gone == nullptr) return;
  gone->next = released_.load(std::memory_order_relaxed);
  while (!released_.compare_exchange_weak(gone->next, gone, std::memory_order_release)) {
  }
}

}  // namespace chimera
