// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include "library/kinematics/testing/arm_rig.h"

namespace chimera::library {
namespace {

struct GinvkinTest : ::testing::Test {
  ArmRig rig{"ginvkin"};
  void SetUp() override {
    rig.build_puma();
    stand(kBent);
  }
  /// Switches on with the arm at `q` and the target at the tool.
  void stand(const Puma560::Vector& q) {
    rig.give("q", q);
    want(Puma560::forward(q));
    ASSERT_TRUE(rig.init());
    ASSERT_TRUE(rig.on());
  }
  void want(const Frame& frame) { rig.set("xr", pose_of(frame)); }
  Frame reached() { return Puma560::forward(rig.six("q_ref")); }
};

TEST_F(GinvkinTest, FollowsAPathToWithinItsTolerance) {
  Puma560::Vector goal = kBent;
  for (int step = 0; step < 1000; ++step) {
    for (std::size_t i = 0; i < 6; ++i) goal[i] = kBent[i] + 0.3 * std::sin(step * 0.005 * static_cast<double>(i + 1));
    want(Puma560::forward(goal));
    ASSERT_TRUE(rig.cycle());
    ASSERT_LT(rig.get<double>("residual"), 1e-6) << "step " << step;
    ASSERT_LT(distance(reached(), Puma560::forward(goal)), 1e-6);
  }
  for (std::size_t i = 0; i < 6; ++i) EXPECT_NEAR(rig.six("q_ref")[i], goal[i], 1e-5);
}

TEST_F(GinvkinTest, SpeedLimitBoundsTheFastestJointAndTheOthersKeepTheirShare) {
  rig.set("speed_limit", 0.5);
  stand(kBent);
  const Puma560::Vector offset{0.02, -0.01, 0.01, 0, 0.005, -0.02};
  Puma560::Vector goal = kBent;
  for (std::size_t i = 0; i < 6; ++i) goal[i] += offset[i];
  want(Puma560::forward(goal));
  ASSERT_TRUE(rig.cycle());  // cycle of 1 ms
  EXPECT_LT(rig.get<double>("residual"), 1e-6) << "of the search, not of where it is";
  const Puma560::Vector first = rig.six("q_ref");
  for (std::size_t i = 0; i < 6; ++i) EXPECT_NEAR(first[i] - kBent[i], offset[i] / 0.02 * 0.0005, 1e-8) << i;
  for (int step = 1; step < 41; ++step) ASSERT_TRUE(rig.cycle());
  for (std::size_t i = 0; i < 6; ++i) EXPECT_NEAR(rig.six("q_ref")[i], goal[i], 1e-7) << i;
}

TEST_F(GinvkinTest, OutOfReachItStretchesTowardsTheTargetAndComesBack) {
  Frame far = Puma560::forward(kBent);
  const Vec3 home = far.origin;
  far.origin = 3.0 * home;
  want(far);
  Puma560::Vector before = kBent;
  for (int step = 0; step < 500; ++step) {
    ASSERT_TRUE(rig.cycle());
    const Puma560::Vector now = rig.six("q_ref");
    for (std::size_t i = 0; i < 6; ++i) ASSERT_LE(std::abs(now[i] - before[i]), 20 * 0.2 + 1e-9);
    before = now;
  }
  EXPECT_GT(rig.get<double>("residual"), 0.3);
  EXPECT_GT(dot(reached().origin, home), dot(home, home));
  far.origin = home;
  want(far);
  for (int step = 0; step < 100; ++step) ASSERT_TRUE(rig.cycle());
  EXPECT_LT(rig.get<double>("residual"), 1e-6);
}

TEST_F(GinvkinTest, AtASingularPoseItStaysBoundedAndGetsAway) {
  const Puma560::Vector wrist{0.3, 0.8, -2.5, 0.4, 0, -0.2};
  stand(wrist);
  Puma560::Vector goal = wrist;
  goal[3] += 0.3, goal[4] += 0.4;
  want(Puma560::forward(goal));
  for (int step = 0; step < 100; ++step) {
    ASSERT_TRUE(rig.cycle());
    for (double angle : rig.six("q_ref")) ASSERT_LT(std::abs(angle), 10);
  }
  EXPECT_LT(rig.get<double>("residual"), 1e-6);
}

TEST_F(GinvkinTest, MovesAnArmOfThreeJointsAsNearAsItCan) {
  ArmRig three("ginvkin");
  three.set("ndof", std::int32_t{3});
  for (std::size_t i = 0; i < 3; ++i) three.set("dh", DhLink{0.3, 0, 0, 0}, i);
  for (std::size_t i = 0; i < 3; ++i) three.set("q", 0.4, i);
  ASSERT_TRUE(three.init());
  ASSERT_TRUE(three.on());
  DhChain chain;
  chain.ndof = 3;
  for (std::size_t i = 0; i < 3; ++i) chain.dh[i] = {0.3, 0, 0, 0};
  const std::array<double, 3> goal{0.5, 0.3, 0.6};
  three.set("xr", pose_of(tool_frame(chain, goal)));
  for (int step = 0; step < 200; ++step) ASSERT_TRUE(three.cycle());
  EXPECT_LT(three.get<double>("residual"), 1e-6);
  for (std::size_t i = 0; i < 3; ++i) EXPECT_NEAR(three.get<double>("q_ref", i), goal[i], 1e-5);
}

TEST_F(GinvkinTest, StaysWithinItsLimitsSaysSoAndComesBack) {
  rig.set("q_max", kBent[1] + 0.1, 1);
  ASSERT_TRUE(rig.reinit());
  Puma560::Vector goal = kBent;
  goal[1] += 0.3;
  want(Puma560::forward(goal));
  for (int step = 0; step < 200; ++step) {
    ASSERT_TRUE(rig.cycle());
    ASSERT_LE(rig.six("q_ref")[1], kBent[1] + 0.1);
  }
  EXPECT_FALSE(rig.get<bool>("is_reachable"));
  EXPECT_GT(rig.get<double>("residual"), 0.01);
  EXPECT_NEAR(rig.get<double>("residual"), distance(reached(), Puma560::forward(goal)), 1e-12);
  want(Puma560::forward(kBent));
  for (int step = 0; step < 50; ++step) ASSERT_TRUE(rig.cycle());
  EXPECT_TRUE(rig.get<bool>("is_reachable"));
  for (std::size_t i = 0; i < 6; ++i) EXPECT_NEAR(rig.six("q_ref")[i], kBent[i], 1e-5);
}

TEST_F(GinvkinTest, NarrowerLimitsCutTheReferenceAtOnce) {
  rig.set("q_max", kBent[1] - 0.05, 1);
  ASSERT_TRUE(rig.reinit());
  EXPECT_EQ(rig.six("q_ref")[1], kBent[1] - 0.05);
  ASSERT_TRUE(rig.on());
  EXPECT_EQ(rig.six("q_ref")[1], kBent[1]) << "where the arm is";
  ASSERT_EQ(rig.notes().size(), 1u);
  EXPECT_EQ(rig.notes()[0], "q_ref[1] starts at 0.8 rad, outside -1e+06 to 0.75 rad");
  ASSERT_TRUE(rig.cycle());
  EXPECT_LE(rig.six("q_ref")[1], kBent[1] - 0.05);
}

TEST_F(GinvkinTest, SpareJointsReplaceAJointAtItsLimit) {
  ArmRig four("ginvkin");
  four.set("ndof", std::int32_t{4});
  DhChain chain;
  chain.ndof = 4;
  const std::array<double, 4> begin{0.5, 0.4, 0.4, 0.4}, goal{0.7, 0.6, 0.2, 0.5};
  for (std::size_t i = 0; i < 4; ++i) {
    four.set("dh", chain.dh[i] = DhLink{0.3, 0, 0, 0}, i);
    four.set("q", begin[i], i);
    four.set("q_min", i == 1 ? 0.4 : -3.0, i);
    four.set("q_max", i == 1 ? 0.4 : 3.0, i);
  }
  ASSERT_TRUE(four.init());
  ASSERT_TRUE(four.on());
  four.set("xr", pose_of(tool_frame(chain, goal)));
  for (int step = 0; step < 200; ++step) ASSERT_TRUE(four.cycle());
  EXPECT_TRUE(four.get<bool>("is_reachable"));
  EXPECT_LT(four.get<double>("residual"), 1e-6);
  EXPECT_EQ(four.get<double>("q_ref", 1), 0.4);
}

// The drives lag behind the command: starting at the measurement would step back by that lag.
TEST_F(GinvkinTest, StartsAtTheHandedOverCommandOrTheMeasurement) {
  Puma560::Vector ahead = kBent;
  for (double& angle : ahead) angle += 0.05;
  want(Puma560::forward(ahead));
  for (std::size_t i = 0; i < 6; ++i) rig.set("q_ref", ahead[i], i);
  rig.inherit("q_ref", milliseconds(2));
  ASSERT_TRUE(rig.on());
  for (std::size_t i = 0; i < 6; ++i) EXPECT_EQ(rig.six("q_ref")[i], ahead[i]);
  ASSERT_TRUE(rig.cycle());
  for (std::size_t i = 0; i < 6; ++i) EXPECT_NEAR(rig.six("q_ref")[i], ahead[i], 1e-6);
  for (std::size_t i = 0; i < 6; ++i) rig.set("q_ref", ahead[i], i);
  rig.inherit("q_ref", milliseconds(20));
  ASSERT_TRUE(rig.on());
  for (std::size_t i = 0; i < 6; ++i) EXPECT_EQ(rig.six("q_ref")[i], kBent[i]) << "an old command";
  rig.set("q_ref", kNotANumber, 2);
  rig.inherit("q_ref", milliseconds(2));
  ASSERT_TRUE(rig.on());
  EXPECT_EQ(rig.six("q_ref")[2], kBent[2]);
}

TEST_F(GinvkinTest, RefusesInvalidLimits) {
  rig.set("q_min", 1.0, 3);
  rig.set("q_max", 0.5, 3);
  EXPECT_EQ(rig.init().text, "a joint limit is not a number, or q_min is above q_max");
  rig.set("q_max", kNotANumber, 3);
  EXPECT_EQ(rig.reinit().text, "a joint limit is not a number, or q_min is above q_max");
}

TEST_F(GinvkinTest, RefusesNonFiniteInputsAndGoesOnAfterThem) {
  rig.set("xr", Pose{{0, kNotANumber, 0}, {1, 0, 0, 0}});
  EXPECT_EQ(rig.refusal(), "xr is not finite or no orientation");
  rig.set("xr", Pose{{0.5, 0, 0}, {0.5, 0, 0, 0}});
  EXPECT_EQ(rig.refusal(), "xr is not finite or no orientation");
  want(Puma560::forward(kBent));
  EXPECT_EQ(rig.refusal(), "accepted");
  rig.set("q", kNotANumber, 0);
  EXPECT_EQ(rig.on().text, "q is not finite: the search cannot begin there");
  rig.set("dh", DhLink{0, 0, kNotANumber, 0}, 0);
  EXPECT_EQ(rig.refusal(), "dh: a number is not finite");
}

TEST_F(GinvkinTest, TheReferenceStandsWhileTheConfigurationIsIllegal) {
  EXPECT_TRUE(rig.stands_while_illegal("q_ref"));
}

}  // namespace
}  // namespace chimera::library
