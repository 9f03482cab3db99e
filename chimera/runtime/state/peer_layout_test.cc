// SPDX-License-Identifier: Apache-2.0
#include "chimera/runtime/state/peer_layout.h"

#include <gtest/gtest.h>

#include "chimera/runtime/testing/two_rtpus.h"
#include "chimera/task/fault_record.h"

namespace chimera {
namespace {

struct PeerLayoutTest : ::testing::Test, testing::TwoRtpus {};

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
