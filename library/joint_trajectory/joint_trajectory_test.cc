// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <cmath>

#include "chimera/task/rig.h"

namespace chimera {
namespace {

struct JointTrajectoryTest : testing::Test {
  Rig rig{"joint_trajectory"};
  void give(double duration) {
    rig.set("ndof", std::int32_t{2});
    rig.set("start_pose", 0.5, 0);
    rig.set("start_pose", -1.0, 1);
    rig.set("goal", 1.5, 0);
    rig.set("goal", -1.0, 1);
    rig.set("duration", duration);
  }
  void start() {
    give(2.0);
    ASSERT_TRUE(rig.init());
    ASSERT_TRUE(rig.on());
  }
};

TEST_F(JointTrajectoryTest, StartsAtRestInItsStartPose) {
  start();
  EXPECT_EQ(rig.size("q_ref"), 2u);
  EXPECT_EQ(rig.get<double>("q_ref", 0), 0.5);
  EXPECT_EQ(rig.get<double>("qd_ref", 0), 0);
}

TEST_F(JointTrajectoryTest, PassesHalfwayAtItsPeakAndHoldsTheGoal) {
  start();
  for (int i = 0; i < 1000; ++i) ASSERT_TRUE(rig.cycle());
  EXPECT_NEAR(rig.get<double>("q_ref", 0), 1.0, 1e-9);
  EXPECT_NEAR(rig.get<double>("qd_ref", 0), 1.875 * 1.0 / 2, 1e-9);
  EXPECT_EQ(rig.get<double>("q_ref", 1), -1.0);
  for (int i = 0; i < 1500; ++i) ASSERT_TRUE(rig.cycle());
  EXPECT_EQ(rig.get<double>("q_ref", 0), 1.5);
  EXPECT_EQ(rig.get<double>("qd_ref", 0), 0);
  EXPECT_EQ(rig.get<double>("qdd_ref", 0), 0);
}

TEST_F(JointTrajectoryTest, StartsAgainFromTheReferenceThatStands) {
  start();
  for (int i = 0; i < 700; ++i) ASSERT_TRUE(rig.cycle());
  const double stands = rig.get<double>("q_ref", 0);
  ASSERT_TRUE(rig.off());
  EXPECT_EQ(rig.get<double>("qd_ref", 0), 0);
  ASSERT_TRUE(rig.on());
  EXPECT_EQ(rig.get<double>("q_ref", 0), stands);
}

TEST_F(JointTrajectoryTest, RefusesADurationOfNothingAndAGoalThatIsNotFinite) {
  give(0);
  EXPECT_EQ(rig.init().text, "duration must be above 0 s");
  give(1);
  rig.set("goal", std::nan(""), 1);
  EXPECT_EQ(rig.init().text, "start_pose and goal must be finite");
}

}  // namespace
}  // namespace chimera
