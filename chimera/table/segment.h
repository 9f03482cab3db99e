// SPDX-License-Identifier: Apache-2.0
// A table in memory that other processes map: a header that describes it, the planned groups, and headroom.
// docs/formats/table.md. Readers compare the header and never trust it. Sizes and offsets come from the plan of the
// reader, or are checked against the mapped bytes.
#pragma once

#include <cstdint>
#include <span>

#include "chimera/base/result.h"
#include "chimera/table/group.h"
#include "chimera/table/layout.h"

namespace chimera {

inline constexpr std::uint64_t kSegmentMagic = 0x314c4254'4d494843;  // "CHIMTBL1" in memory
inline constexpr std::uint32_t kSegmentVersion = 1;

/// At the start of every segment; never changes after format().
struct SegmentHeader {
  std::uint64_t magic = kSegmentMagic;
  std::uint32_t version = kSegmentVersion;
  std::uint32_t header_bytes = 64;
  std::uint64_t total_bytes = 0;
  std::uint64_t layout_hash = 0;
  std::uint64_t layout_bytes = 0;  ///< of the planned groups, behind the header
  std::uint64_t reserved[3] = {};
};
static_assert(sizeof(SegmentHeader) == 64);

/// The place of a group. A link holds no address, because each process maps a segment at a different one.
struct Link {
  std::uint32_t segment = UINT32_MAX;  ///< number of the segment, from 0
  std::uint32_t payload_bytes = 0;
  std::uint64_t offset = 0;  ///< from the start of the segment; multiple of 64

  constexpr bool operator==(const Link&) const noexcept = default;
};

/// A segment as a reader sees it: a plain value over mapped bytes.
class SegmentView {
 public:
  /// Refuses bytes that are no segment, and a segment with another version, layout or size. Context: setup.
  static Result<SegmentView> open(std::span<const std::byte> bytes, std::uint64_t layout_hash) noexcept;

  /// The group that `link` names; the caller checks its segment number. Refuses a group that is not aligned or reaches
  /// beyond the segment. Context: setup, or at a rebinding in a cycle: wait-free.
  Result<GroupReader> group(const Link& link) const noexcept;
  /// A link to the planned group `id` in segment `number`. Requires: `layout` has the hash of open().
  static Link planned(const TableLayout& layout, GroupId id, std::uint32_t number) noexcept;

 private:
  explicit SegmentView(std::span<const std::byte> bytes) noexcept : bytes_(bytes) {}
  std::span<const std::byte> bytes_;
};

/// The owner of a segment: formats it, and gives out the headroom.
class SegmentOwner {
 public:
  /// Writes the header; all other bytes must be zero. Refuses too few bytes for the layout, with the missing number.
  /// Requires: 64-byte aligned. Context: setup.
  static Result<SegmentOwner> format(std::span<std::byte> bytes, const TableLayout& layout) noexcept;

  /// Reserves one more group in the headroom; it is never returned. Refuses when the headroom is used up.
  Result<Link> claim(std::uint32_t payload_bytes, std::uint32_t number) noexcept;
  /// Requires: a link of this segment, from planned() or claim().
  GroupWriter writer(const Link& link) const noexcept;
  std::uint64_t headroom_bytes() const noexcept { return bytes_.size() - used_; }

 private:
  SegmentOwner(std::span<std::byte> bytes, std::uint64_t used) noexcept : bytes_(bytes), used_(used) {}
  std::span<std::byte> bytes_;
  std::uint64_t used_ = 0;  // kept outside the segment, because other processes could write there
};

/// Bytes of a segment with the planned groups and `headroom_bytes`.
inline std::uint64_t segment_bytes(const TableLayout& layout, std::uint64_t headroom_bytes) noexcept {
  return sizeof(SegmentHeader) + layout.region_bytes() + headroom_bytes;
}

}  // namespace chimera
