// SPDX-License-Identifier: Apache-2.0
// Writes and checks the header of a segment, and finds groups in it.
#include "chimera/table/segment.h"

#include <cstring>

#include "chimera/base/assert.h"
#include "chimera/base/message.h"
#include "chimera/table/slot.h"

namespace chimera {
namespace {

bool fits(std::uint64_t size, const Link& link) noexcept {
  if (link.payload_bytes > kMaxPayloadBytes || link.offset % kCacheLine != 0) return false;
  if (link.offset < sizeof(SegmentHeader) || link.offset > size) return false;
  return group_bytes(link.payload_bytes) <= size - link.offset;  // subtracts, because a sum could overflow
}

}  // namespace

Result<SegmentView> SegmentView::open(std::span<const std::byte> bytes, std::uint64_t layout_hash) noexcept {
  if (bytes.size() < sizeof(SegmentHeader))
    return (Message() << "segment of " << bytes.size() << " bytes is shorter than its header of "
                      << sizeof(SegmentHeader))
        .error(ErrorCode::kBadInput);
  SegmentHeader header;  // copied once: a broken owner may change the original at any time
  std::memcpy(&header, bytes.data(), sizeof header);
  if (header.magic != kSegmentMagic)
    return Message("not a state variable table: the first 8 bytes are not CHIMTBL1").error(ErrorCode::kBadInput);
  if (header.version != kSegmentVersion || header.header_bytes != sizeof header)
    return (Message() << "table of format version " << header.version << ", expected " << kSegmentVersion
                      << ": both sides must be of one release")
        .error(ErrorCode::kUnsupported);
  if (header.total_bytes != bytes.size())
    return (Message() << "segment says it has " << header.total_bytes << " bytes, " << bytes.size() << " are mapped")
        .error(ErrorCode::kBadInput);
  if (header.layout_hash != layout_hash)
    return Message("table was planned from another configuration: its layout hash differs").error(ErrorCode::kRefused);
  return SegmentView(bytes);
}

Result<GroupReader> SegmentView::group(const Link& link) const noexcept {
  if (!fits(bytes_.size(), link))
    return (Message() << "link to " << link.payload_bytes << " bytes at offset " << link.offset
                      << " does not lie in its segment of " << bytes_.size() << " bytes")
        .error(ErrorCode::kBadInput);
  return GroupReader(bytes_.data() + link.offset, link.payload_bytes);
}

Link SegmentView::planned(const TableLayout& layout, GroupId id, std::uint32_t number) noexcept {
  const GroupPlace& place = layout.group(id);
  return {number, place.payload_bytes, sizeof(SegmentHeader) + place.offset};
}

Result<SegmentOwner> SegmentOwner::format(std::span<std::byte> bytes, const TableLayout& layout) noexcept {
  CHIMERA_ASSERT(reinterpret_cast<std::uintptr_t>(bytes.data()) % kCacheLine == 0);
  const std::uint64_t needed = segment_bytes(layout, 0);
  if (bytes.size() < needed)
    return (Message() << "the table needs a segment of " << needed << " bytes, " << bytes.size() << " were given: "
                      << needed - bytes.size() << " too few")
        .error(ErrorCode::kRefused);
  SegmentHeader header;
  header.total_bytes = bytes.size();
  header.layout_hash = layout.hash();
  header.layout_bytes = layout.region_bytes();
  std::memcpy(bytes.data(), &header, sizeof header);
  return SegmentOwner(bytes, needed);
}

Result<Link> SegmentOwner::claim(std::uint32_t payload_bytes, std::uint32_t number) noexcept {
  const std::uint64_t needed = group_bytes(payload_bytes);
  if (payload_bytes > kMaxPayloadBytes || needed > headroom_bytes())
    return (Message() << "a group of " << payload_bytes << " bytes needs " << needed << ", the segment's headroom is "
                      << headroom_bytes())
        .error(ErrorCode::kRefused);
  const Link link{number, payload_bytes, used_};
  used_ += needed;
  return link;
}

GroupWriter SegmentOwner::writer(const Link& link) const noexcept {
  CHIMERA_ASSERT(fits(used_, link));
  return GroupWriter(bytes_.subspan(link.offset, group_bytes(link.payload_bytes)), link.payload_bytes);
}

}  // namespace chimera
