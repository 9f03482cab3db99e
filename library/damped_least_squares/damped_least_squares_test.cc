// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include "library/kinematics/testing/arm_rig.h"

namespace chimera::library {
namespace {

struct DampedLeastSquaresTest : ::testing::Test {
  ArmRig rig{"damped_least_squares"};
  Jacobian jacobian;

  void SetUp() override {
    rig.set("ndof", std::int32_t{6});
    rig.set("gain", 2.0);
    stand(kBent);
    ASSERT_TRUE(rig.init());
    ASSERT_TRUE(rig.on());
  }
  /// Puts the arm at `q` and the target at the tool.
  void stand(const Puma560::Vector& q) {
    const Pose pose = pose_of(Puma560::forward(q, jacobian));
    rig.give_jacobian(jacobian, 6);
    rig.set("xm", pose);
    rig.set("xd", pose);
  }
  void want(const Vec3& way) {
    Pose goal = rig.get<Pose>("xm");
    for (std::size_t r = 0; r < 3; ++r) goal.position[r] += way[r];
    rig.set("xd", goal);
  }
};

TEST_F(DampedLeastSquaresTest, TheToolMovesTowardsTheTargetAtGainTimesTheError) {
  want({0.01, -0.02, 0.03});
  ASSERT_TRUE(rig.cycle());
  const Puma560::Vector speed = rig.six("qd_ref");
  for (std::size_t r = 0; r < 6; ++r) {
    double motion = 0;
    for (std::size_t i = 0; i < 6; ++i) motion += DampedInverse::element(jacobian, r, i) * speed[i];
    EXPECT_NEAR(motion, r == 0 ? 0.02 : r == 1 ? -0.04 : r == 2 ? 0.06 : 0, 1e-8);
  }
}

TEST_F(DampedLeastSquaresTest, SpeedsThatAreHandedOverStandUntilTheFirstCycle) {
  rig.set("qd_ref", 0.7, 2);
  rig.inherit("qd_ref", milliseconds(2));
  ASSERT_TRUE(rig.on());
  EXPECT_EQ(rig.six("qd_ref")[2], 0.7);
  ASSERT_TRUE(rig.cycle());
  EXPECT_NEAR(rig.six("qd_ref")[2], 0, 1e-9) << "the law has no memory";
  rig.set("qd_ref", 0.7, 2);
  rig.inherit("qd_ref", milliseconds(20));
  ASSERT_TRUE(rig.on());
  EXPECT_EQ(rig.six("qd_ref")[2], 0) << "old speeds";
}

TEST_F(DampedLeastSquaresTest, BringsTheArmToItsTargetThroughASingularPose) {
  Puma560::Vector q{0.3, 0.8, -2.5, 0.4, -0.3, -0.2}, goal = q;
  goal[4] = 0.3;  // the wrist stretches on the way
  const Pose target = pose_of(Puma560::forward(goal));
  double least = 1;
  for (int step = 0; step < 8000; ++step) {
    stand(q);
    rig.set("xd", target);
    ASSERT_TRUE(rig.cycle());
    const Puma560::Vector speed = rig.six("qd_ref");
    for (std::size_t i = 0; i < 6; ++i) {
      ASSERT_LE(std::abs(speed[i]), 2 + 1e-12);
      q[i] += speed[i] * 1e-3;
    }
    least = std::min(least, rig.get<double>("manipulability"));
  }
  EXPECT_LT(least, 2e-3);
  EXPECT_LT(distance(Puma560::forward(q), Puma560::forward(goal)), 1e-4);
}

TEST_F(DampedLeastSquaresTest, SpeedsAreCutTogether) {
  want({0.01, 0.01, 0.01});
  ASSERT_TRUE(rig.cycle());
  const Puma560::Vector slow = rig.six("qd_ref");
  want({10, 10, 10});
  ASSERT_TRUE(rig.cycle());
  const Puma560::Vector fast = rig.six("qd_ref");
  double fastest = 0;
  for (double speed : fast) fastest = std::max(fastest, std::abs(speed));
  EXPECT_DOUBLE_EQ(fastest, 2);
  for (std::size_t i = 0; i < 6; ++i) EXPECT_NEAR(fast[i] / fast[0], slow[i] / slow[0], 1e-9);
}

TEST_F(DampedLeastSquaresTest, SpeedsAreZeroWhileTheConfigurationIsIllegalAndAfterOff) {
  want({0.1, 0, 0});
  ASSERT_TRUE(rig.cycle());
  EXPECT_NE(rig.six("qd_ref"), Puma560::Vector{});
  rig.illegal(true);
  ASSERT_TRUE(rig.cycle());
  EXPECT_EQ(rig.six("qd_ref"), Puma560::Vector{});
  rig.illegal(false);
  ASSERT_TRUE(rig.cycle());
  ASSERT_TRUE(rig.off());
  EXPECT_EQ(rig.six("qd_ref"), Puma560::Vector{});
}

TEST_F(DampedLeastSquaresTest, RefusesNonFiniteInputsAndGoesOnAfterThem) {
  rig.set("xd", Pose{{kNotANumber, 0, 0}, {1, 0, 0, 0}});
  EXPECT_EQ(rig.refusal(), "a pose is not finite, or has no orientation");
  stand(kBent);
  rig.set("jv", kNotANumber, 3);
  EXPECT_EQ(rig.refusal(), "the Jacobian is not finite, or too large");
  stand(kBent);
  rig.set("jw", 1e200, 3);
  EXPECT_EQ(rig.refusal(), "the Jacobian is not finite, or too large");
  stand(kBent);
  EXPECT_EQ(rig.refusal(), "accepted");
}

}  // namespace
}  // namespace chimera::library
