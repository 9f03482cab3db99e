// SPDX-License-Identifier: Apache-2.0
// Maps and checks the shared-memory segment of another process.
#include "chimera/runtime/hosted/peer_segment.h"

#include <utility>

#include "chimera/base/message.h"

namespace chimera {

Result<PeerSegment> PeerSegment::open(int descriptor, const PeerLayout& layout, std::uint32_t n_tasks,
                                      std::uint32_t peer, std::uint32_t incarnation) {
  auto region = MemoryRegion::open_read_only(descriptor, peer_segment_bytes(layout.table(), n_tasks));
  if (!region) return region.error();
  PeerSegment made;
  made.region_ = *std::move(region);
  made.layout_ = &layout;
  made.incarnation_ = incarnation;
  made.peer_ = peer;
  made.n_tasks_ = n_tasks;
  made.block_ = BlockView(made.region_.bytes().data() + block_offset(layout.table()), n_tasks);
  if (const auto whole = made.check(); !whole) return whole.error();
  return made;
}

Result<void> PeerSegment::check() const {
  if (const auto table = SegmentView::open(region_.bytes(), layout_->table().hash()); !table) return table.error();
  const BlockHead& head = block_.head();
  if (head.magic == kBlockMagic && head.peer == peer_ && head.incarnation == incarnation_ && head.n_tasks == n_tasks_)
    return {};
  return (Message() << "segment says peer " << head.peer << " in incarnation " << head.incarnation << " with "
                    << head.n_tasks << " tasks, expected " << peer_ << ", " << incarnation_ << ", " << n_tasks_)
      .error(ErrorCode::kBadInput);
}

GroupReader PeerSegment::group(GroupId id) const noexcept {
  const Link link = SegmentView::planned(layout_->table(), id, 0);
  return GroupReader(region_.bytes().data() + link.offset, link.payload_bytes);
}

}  // namespace chimera
