// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <cmath>

#include "chimera/task/rig.h"

namespace chimera {
namespace {

struct TrackingMonitorTest : ::testing::Test {
  Rig rig{"tracking_monitor"};
  void start() {
    rig.set("ndof", std::int32_t{2});
    rig.set("window", 0.01);
    place(1.0, -1.0);
    ASSERT_TRUE(rig.init());
    ASSERT_TRUE(rig.on());
  }
  void place(double first, double second) {
    rig.set("q", first, 0);
    rig.set("q", second, 1);
    rig.set("q_ref", 1.0, 0);
    rig.set("q_ref", -1.0, 1);
  }
};

TEST_F(TrackingMonitorTest, PublishesTheWorstJointNowAndEver) {
  start();
  place(1.02, -1.05);
  ASSERT_TRUE(rig.cycle());
  EXPECT_NEAR(rig.get<double>("error_now"), 0.05, 1e-12);
  place(0.99, -1.0);
  ASSERT_TRUE(rig.cycle());
  EXPECT_NEAR(rig.get<double>("error_now"), 0.01, 1e-12);
  EXPECT_NEAR(rig.get<double>("max_error"), 0.05, 1e-12);
}

TEST_F(TrackingMonitorTest, MovedIsTheJointThatMovedLeast) {
  start();
  place(1.6, -1.2);
  ASSERT_TRUE(rig.cycle());
  EXPECT_NEAR(rig.get<double>("moved"), 0.2, 1e-12);
  place(1.0, -1.0);  // returns: the farthest place counts
  ASSERT_TRUE(rig.cycle());
  EXPECT_NEAR(rig.get<double>("moved"), 0.2, 1e-12);
}

TEST_F(TrackingMonitorTest, MovedLooksAtItsWindowOnly) {
  start();
  for (int i = 0; i < 9; ++i) ASSERT_TRUE(rig.cycle());
  place(1.5, -1.5);
  ASSERT_TRUE(rig.cycle());  // the last cycle within 10 ms
  EXPECT_NEAR(rig.get<double>("moved"), 0.5, 1e-12);
  place(2.5, -2.5);
  ASSERT_TRUE(rig.cycle());
  EXPECT_NEAR(rig.get<double>("moved"), 0.5, 1e-12);
}

TEST_F(TrackingMonitorTest, AContinuousJointIsJudgedByTheShortWay) {
  rig.set("ndof", std::int32_t{2});
  rig.set("is_continuous", true, 0);
  start();
  place(1.0 + 2 * M_PI - 0.1, -1.3);
  ASSERT_TRUE(rig.cycle());
  EXPECT_NEAR(rig.get<double>("error_now"), 0.3, 1e-12) << "joint 0 is 0.1 rad away";
  EXPECT_NEAR(rig.get<double>("moved"), 0.1, 1e-12);
}

TEST_F(TrackingMonitorTest, OnBeginsAnew) {
  start();
  place(2, -2);
  ASSERT_TRUE(rig.cycle());
  ASSERT_TRUE(rig.on());
  EXPECT_EQ(rig.get<double>("max_error"), 0);
  EXPECT_EQ(rig.get<double>("moved"), 0);
  ASSERT_TRUE(rig.cycle());
  EXPECT_EQ(rig.get<double>("moved"), 0);
}

TEST_F(TrackingMonitorTest, PositionThatIsNotANumberIsAFault) {
  start();
  rig.set("q_ref", std::nan(""), 1);
  EXPECT_EQ(rig.cycle().text, "a position is not finite");
}

}  // namespace
}  // namespace chimera
