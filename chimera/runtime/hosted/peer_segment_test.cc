// SPDX-License-Identifier: Apache-2.0
#include "chimera/runtime/hosted/peer_segment.h"

#include <gtest/gtest.h>

#include <cstring>

#include "chimera/runtime/hosted/heap_memory.h"
#include "chimera/runtime/testing/test_application.h"

namespace chimera::peer_segment_test {
namespace {

struct Producer {
  Out<double> x{"x", "1", initial = 2.5};
  void cycle(Cycle) {}
};

constexpr std::uint32_t kPeer = 0, kIncarnation = 3, kTasks = 1;

struct PeerSegmentTest : ::testing::Test {
  PeerSegmentTest() {
    app.rtpus = {{"first", 0, Policy::kEdf}};
    app.add("producer", testing::component<Producer>("producer")).rtpu = RtpuId(0u);
    app.make();
    layout = std::make_unique<PeerLayout>(*PeerLayout::of(app.spec, kPeer, heap));
    region = *MemoryRegion::create("test", peer_segment_bytes(layout->table(), kTasks));
    EXPECT_TRUE(SegmentOwner::format(region.writable(), layout->table()));
    block = BlockOwner(region.writable().data() + block_offset(layout->table()), kPeer, kIncarnation, kTasks, 2);
  }
  /// Opened as what it is, but for what a test changes.
  std::string refusal(std::uint32_t peer = kPeer, std::uint32_t incarnation = kIncarnation,
                      std::uint32_t n_tasks = kTasks) {
    const auto opened = PeerSegment::open(region.descriptor(), *layout, n_tasks, peer, incarnation);
    return opened ? "" : std::string(opened.error().message.view());
  }

  testing::TestApplication app;
  HeapMemory heap;
  std::unique_ptr<PeerLayout> layout;
  MemoryRegion region;
  BlockOwner block;
};

TEST_F(PeerSegmentTest, ShowsTheBlockAndTheGroupsOfItsOwner) {
  const auto opened = PeerSegment::open(region.descriptor(), *layout, kTasks, kPeer, kIncarnation);
  ASSERT_TRUE(opened) << opened.error().message.view();
  EXPECT_TRUE(opened->is_there());
  EXPECT_EQ(opened->incarnation(), kIncarnation);
  block.set_status(TaskId(0u), {State::kOn, false, 7});
  EXPECT_EQ(opened->block().status(TaskId(0u)).incarnation, 7u);
  const GroupPlace& place = layout->place(layout->outputs(TaskId(0u), 0));
  GroupWriter writer(region.writable().subspan(sizeof(SegmentHeader) + place.offset, group_bytes(place.payload_bytes)),
                     place.payload_bytes);
  const double value = 42;
  std::memcpy(writer.staging(), &value, sizeof value);
  writer.publish(milliseconds(1), 1);
  double read = 0;
  chimera_slot slot;
  ASSERT_TRUE(opened->group(layout->outputs(TaskId(0u), 0)).try_read(slot, reinterpret_cast<std::byte*>(&read)));
  EXPECT_EQ(read, 42);
}

TEST_F(PeerSegmentTest, IsEmptyUntilAssigned) { EXPECT_FALSE(PeerSegment().is_there()); }

TEST_F(PeerSegmentTest, RefusesAnotherPeer) {
  EXPECT_EQ(refusal(1), "segment says peer 0 in incarnation 3 with 1 tasks, expected 1, 3, 1");
}

TEST_F(PeerSegmentTest, RefusesAnotherIncarnation) {
  EXPECT_EQ(refusal(kPeer, 4), "segment says peer 0 in incarnation 3 with 1 tasks, expected 0, 4, 1");
}

TEST_F(PeerSegmentTest, RefusesABlockThatWasNeverFormatted) {
  block.head().magic = 0;
  EXPECT_NE(refusal(), "");
}

TEST_F(PeerSegmentTest, RefusesAnotherNumberOfTasks) {
  block.head().n_tasks = 2;
  EXPECT_EQ(refusal(), "segment says peer 0 in incarnation 3 with 2 tasks, expected 0, 3, 1");
}

TEST_F(PeerSegmentTest, RefusesTheLayoutOfAnotherApplication) {
  const PeerLayout managers = *PeerLayout::of(app.spec, 1, heap);
  EXPECT_FALSE(PeerSegment::open(region.descriptor(), managers, kTasks, kPeer, kIncarnation));
}

TEST_F(PeerSegmentTest, RefusesADescriptorThatIsNoMemory) {
  EXPECT_FALSE(PeerSegment::open(-1, *layout, kTasks, kPeer, kIncarnation));
}

}  // namespace
}  // namespace chimera::peer_segment_test
