// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include "library/signals/testing/signal_rig.h"

namespace chimera {
namespace {

struct JoinPriorityTest : ::testing::Test {
  SignalRig rig{"join_priority", 2};
  void start(double max_age) {
    rig.instances("in", 3);
    rig.set("max_age", max_age);
    ASSERT_TRUE(rig.init());
    ASSERT_TRUE(rig.on());
  }
  void give(std::size_t input, double value) {
    for (std::size_t i = 0; i < 2; ++i) rig.set("in", value + static_cast<double>(i), i, input);
  }
  std::int32_t chosen() { return rig.get<std::int32_t>("chosen"); }
};

TEST_F(JoinPriorityTest, TakesTheFirstThatHasBeenWritten) {
  start(0.1);
  EXPECT_EQ(chosen(), -1);
  EXPECT_TRUE(std::isnan(rig.get<double>("out")));  // never written
  give(2, 20);
  ASSERT_TRUE(rig.cycle());
  EXPECT_EQ(chosen(), 2);
  give(1, 10);
  ASSERT_TRUE(rig.cycle());
  EXPECT_EQ(chosen(), 1);
  EXPECT_EQ(rig.get<double>("out", 0), 10);
  EXPECT_EQ(rig.get<double>("out", 1), 11);
}

TEST_F(JoinPriorityTest, LeavesAnInputThatIsTooOldUntilItIsRenewed) {
  start(0.01);
  give(0, 1);
  give(1, 5);
  for (int ms = 1; ms <= 10; ++ms) ASSERT_TRUE(rig.cycle());
  EXPECT_EQ(chosen(), 0);
  give(1, 6);
  ASSERT_TRUE(rig.cycle());
  EXPECT_EQ(chosen(), 1);
  give(0, 2);
  ASSERT_TRUE(rig.cycle());
  EXPECT_EQ(chosen(), 0);
  EXPECT_EQ(rig.get<double>("out", 0), 2);
}

TEST_F(JoinPriorityTest, WithoutAMaximumAgeAnOldInputCounts) {
  start(0);
  give(0, 1);
  ASSERT_TRUE(rig.cycle(seconds(1000)));
  EXPECT_EQ(chosen(), 0);
}

TEST_F(JoinPriorityTest, PassesOverNaNAndHoldsWhenNothingIsLeft) {
  start(0.1);
  give(0, 1);
  ASSERT_TRUE(rig.cycle());
  rig.set("in", std::nan(""), 1, 0);
  ASSERT_TRUE(rig.cycle());
  EXPECT_EQ(chosen(), -1);
  EXPECT_EQ(rig.get<double>("out", 0), 1);
  give(2, 7);
  ASSERT_TRUE(rig.cycle());
  EXPECT_EQ(chosen(), 2);
}

TEST_F(JoinPriorityTest, RefusesNothingToJoinAndAnAgeBelowNothing) {
  rig.instances("in", 0);
  EXPECT_EQ(rig.init().text, "there is nothing to join: name at least one input");
  rig.instances("in", 1);
  rig.set("max_age", -1.0);
  EXPECT_EQ(rig.init().text, "max_age must be 0 s or more");
}

}  // namespace
}  // namespace chimera
