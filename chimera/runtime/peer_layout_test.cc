// SPDX-License-Identifier: Apache-2.0
#include "chimera/runtime/peer_layout.h"

#include <gtest/gtest.h>

#include "chimera/runtime/hosted/heap_memory.h"
#include "chimera/runtime/testing/test_application.h"
#include "chimera/task/fault_record.h"

namespace chimera {
namespace {

struct Source {
  Out<double> a{"a", "1"};
  Out<double> b{"b", "1"};
  OutConst<std::int32_t> n{"n", "1"};
  void init() { *n = 3; }
  void cycle(Cycle) {}
};

struct Sink {
  In<double> a{"a", "1"};
  void cycle(Cycle) {}
};

struct PeerLayoutTest : ::testing::Test {
  PeerLayoutTest() {
    app.rtpus = {{"first", 0, Policy::kEdf}, {"second", 1, Policy::kEdf}};
    app.add("source", testing::component<Source>("source")).rtpu = RtpuId(1u);
    app.add("sink", testing::component<Sink>("sink")).rtpu = RtpuId(0u);
    app.give(app.operators, "gain", CHIMERA_FLOAT64, testing::bytes_of(1.0));
    app.make();
  }
  testing::TestApplication app;
  HeapMemory heap;
};

TEST_F(PeerLayoutTest, GivesATaskFourGroupsInTheSegmentOfItsRtpuOnly) {
  const auto first = PeerLayout::of(app.spec, 0, heap), second = PeerLayout::of(app.spec, 1, heap);
  ASSERT_TRUE(first && second);
  EXPECT_FALSE(first->has(TaskId(0u)));
  EXPECT_TRUE(first->has(TaskId(1u)));
  ASSERT_TRUE(second->has(TaskId(0u)));
  EXPECT_EQ(second->table().groups().size(), 4u);
  EXPECT_EQ(second->place(second->outputs(TaskId(0u), 0)).payload_bytes, 16u);
  EXPECT_EQ(second->variables(second->outputs(TaskId(0u), 1))[1].offset, 8u);
  EXPECT_EQ(second->place(second->constants(TaskId(0u))).payload_bytes, 8u);
  EXPECT_EQ(second->place(second->fault(TaskId(0u))).payload_bytes, sizeof(FaultRecord));
}

TEST_F(PeerLayoutTest, PutsOperatorVariablesIntoTheManagersSegment) {
  const auto manager = PeerLayout::of(app.spec, 2, heap);
  ASSERT_TRUE(manager);
  EXPECT_EQ(manager->table().groups().size(), 1u);
  EXPECT_EQ(manager->place(manager->operator_group(0)).payload_bytes, 8u);
}

TEST_F(PeerLayoutTest, HoldsEverythingInASingleContext) {
  const auto all = PeerLayout::of_everything(app.spec, heap);
  ASSERT_TRUE(all);
  EXPECT_EQ(all->table().groups().size(), 9u);
  EXPECT_EQ(all->operator_group(0), GroupId(8u));
}

}  // namespace
}  // namespace chimera
