// SPDX-License-Identifier: Apache-2.0
#include "chimera/table/segment.h"

#include <gtest/gtest.h>

#include <array>
#include <cstring>
#include <vector>

#include "chimera/table/slot.h"

namespace chimera {
namespace {

constexpr std::uint64_t kHeadroom = 1024;

struct Fixture : ::testing::Test {
  Fixture() {
    layout = TableLayout::plan(specs, 1u << 20, groups, variables).value();
    lines.resize(segment_bytes(layout, kHeadroom) / kCacheLine);
  }
  struct alignas(kCacheLine) Line { std::byte b[kCacheLine]{}; };
  std::span<std::byte> bytes() { return std::as_writable_bytes(std::span(lines)); }
  template <class T>
  void poke(std::size_t offset, T value) { std::memcpy(bytes().data() + offset, &value, sizeof value); }
  std::string refusal() {
    const auto view = SegmentView::open(bytes(), layout.hash());
    return view ? "accepted" : std::string(view.error().message.view());
  }

  std::array<VariableSpec, 1> arm{VariableSpec{"q", 8, 2}};
  std::array<GroupSpec, 2> specs{GroupSpec{"arm", arm}, GroupSpec{"pid", arm}};
  std::array<GroupPlace, 2> groups;
  std::array<VariablePlace, 2> variables;
  TableLayout layout;
  std::vector<Line> lines;
};
using Segment = Fixture;

TEST_F(Segment, WriterAndReaderMeetThroughALink) {
  auto owner = SegmentOwner::format(bytes(), layout);
  ASSERT_TRUE(owner.has_value());
  const Link link = SegmentView::planned(layout, GroupId(1u), 0);
  EXPECT_EQ(link.offset, 64 + group_bytes(16));
  GroupWriter writer = owner->writer(link);
  const std::array<double, 2> q{1, 2};
  writer.write(reinterpret_cast<const std::byte*>(q.data()), Nanoseconds{7}, 1);
  const auto view = SegmentView::open(bytes(), layout.hash());
  ASSERT_TRUE(view.has_value());
  const auto reader = view->group(link);
  ASSERT_TRUE(reader.has_value());
  EXPECT_EQ(reader->published()->sequence, 1u);
  EXPECT_EQ(view->group(SegmentView::planned(layout, GroupId(0u), 0))->published()->sequence, 0u);
}

TEST_F(Segment, HeadroomGivesFurtherGroupsUntilItIsUsedUp) {
  auto owner = SegmentOwner::format(bytes(), layout);
  EXPECT_EQ(owner->headroom_bytes(), kHeadroom);
  const auto first = owner->claim(16, 3);
  ASSERT_TRUE(first.has_value());
  EXPECT_EQ(*first, (Link{3, 16, segment_bytes(layout, 0)}));
  const auto second = owner->claim(200, 3);
  ASSERT_FALSE(second.has_value());
  EXPECT_EQ(second.error().message.view(), "a group of 200 bytes needs 1088, the segment's headroom is 704");
  EXPECT_TRUE(owner->claim(16, 3).has_value());
  EXPECT_EQ(owner->headroom_bytes(), kHeadroom - 2 * group_bytes(16));
  EXPECT_FALSE(owner->claim(UINT32_MAX, 3).has_value());
}

TEST_F(Segment, RefusesStrangers) {
  EXPECT_EQ(refusal(), "not a state variable table: the first 8 bytes are not CHIMTBL1");
  ASSERT_TRUE(SegmentOwner::format(bytes(), layout).has_value());
  EXPECT_EQ(std::memcmp(bytes().data(), "CHIMTBL1", 8), 0);
  EXPECT_EQ(refusal(), "accepted");
  poke(8, std::uint32_t{2});
  EXPECT_EQ(refusal(), "table of format version 2, expected 1: both sides must be of one release");
  poke(8, std::uint32_t{1});
  poke(16, std::uint64_t{1} << 60);
  EXPECT_EQ(refusal(), "segment says it has 1152921504606846976 bytes, 1728 are mapped");
  poke(16, static_cast<std::uint64_t>(bytes().size()));
  poke(24, layout.hash() + 1);
  EXPECT_EQ(refusal(), "table was planned from another configuration: its layout hash differs");
  const auto stub = SegmentView::open(bytes().first(63), layout.hash());
  ASSERT_FALSE(stub.has_value());
  EXPECT_EQ(stub.error().message.view(), "segment of 63 bytes is shorter than its header of 64");
}

TEST_F(Segment, RefusesLinksThatLeaveTheSegment) {
  ASSERT_TRUE(SegmentOwner::format(bytes(), layout).has_value());
  const auto view = SegmentView::open(bytes(), layout.hash());
  const std::uint64_t size = bytes().size();
  for (const Link& link : {Link{0, 16, 0},                         // the header itself
                           Link{0, 16, 72},                        // not aligned
                           Link{0, 16, size - 64}, Link{0, 16, size}, Link{0, 16, size + 64},
                           Link{0, 16, UINT64_MAX - 63},           // would wrap around
                           Link{0, UINT32_MAX, 64}, Link{0, 1u << 20, 64}})
    EXPECT_FALSE(view->group(link).has_value()) << link.offset << " " << link.payload_bytes;
  EXPECT_EQ(view->group(Link{0, 16, 72}).error().message.view(),
            "link to 16 bytes at offset 72 does not lie in its segment of 1728 bytes");
  EXPECT_TRUE(view->group(Link{0, 16, size - group_bytes(16)}).has_value());
}

TEST_F(Segment, RefusesBytesTooFewForTheLayout) {
  const auto owner = SegmentOwner::format(bytes().first(segment_bytes(layout, 0) - 64), layout);
  ASSERT_FALSE(owner.has_value());
  EXPECT_EQ(owner.error().message.view(), "the table needs a segment of 704 bytes, 640 were given: 64 too few");
}

}  // namespace
}  // namespace chimera
