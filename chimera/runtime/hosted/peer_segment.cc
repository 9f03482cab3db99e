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
  if (const auto table = SegmentView::open(region->bytes(), layout.table().hash()); !table) return table.error();
  PeerSegment made;
  made.block_ = BlockView(region->bytes().data() + block_offset(layout.table()), n_tasks);
  const BlockHead& head = made.block_.head();
  if (head.magic != kBlockMagic || head.peer != peer || head.incarnation != incarnation || head.n_tasks != n_tasks)
    return (Message() << "segment says peer " << head.peer << " in incarnation " << head.incarnation << " with "
                      << head.n_tasks << " tasks, expected " << peer << ", " << incarnation << ", " << n_tasks)
        .error(ErrorCode::kBadInput);
  made.region_ = *std::move(region);
  made.layout_ = &layout;
  made.incarnation_ = incarnation;
  return made;
}

GroupReader PeerSegment::group(GroupId id) const noexcept {
  const Link link = SegmentView::planned(layout_->table(), id, 0);
  return GroupReader(region_.bytes().data() + link.offset, link.payload_bytes);
}

}  // namespace chimera
