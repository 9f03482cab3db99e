// SPDX-License-Identifier: Apache-2.0
#include "chimera/subsystem/order.h"

#include <gtest/gtest.h>

#include "chimera/subsystem/testing/test_world.h"

namespace chimera::subsystem {
namespace {

struct OrderTest : ::testing::Test, TestWorld {
  std::string order() const {
    std::string text;
    for (TaskId task : data_flow_order(spec))
      text += (text.empty() ? "" : " ") + std::string(spec.tasks[task.index].name);
    return text;
  }
};

TEST_F(OrderTest, TheStartSetKeepsItsOrder) { EXPECT_EQ(order(), "arm traj pid reserve"); }

TEST_F(OrderTest, WithoutAStartSetHardwareComesFirstAndProducersBeforeConsumers) {
  spec.start = {};
  EXPECT_EQ(order(), "arm traj pid reserve");
}

TEST_F(OrderTest, ProducersOutsideTheStartSetComeBeforeTheirConsumersInIt) {
  const std::vector<TaskId> start{kArm, kPid};
  spec.start = start;
  EXPECT_EQ(order(), "arm traj pid reserve");
}

TEST_F(OrderTest, MakersOfConstantsAreFoundByName) {
  const auto makers = makers_of_constants(spec);
  EXPECT_TRUE(makers[kArm.index].empty());
  EXPECT_EQ(makers[kPid.index], std::vector<TaskId>{kArm});
  EXPECT_EQ(makers[kReserve.index], std::vector<TaskId>{kArm});
}

}  // namespace
}  // namespace chimera::subsystem
