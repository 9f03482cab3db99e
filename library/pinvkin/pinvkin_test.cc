// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include "library/kinematics/testing/arm_rig.h"

namespace chimera::library {
namespace {

struct PinvkinTest : ::testing::Test {
  ArmRig rig{"pinvkin"};
  void SetUp() override {
    rig.give("q", kBent);
    want(Puma560::forward(kBent));
    ASSERT_TRUE(rig.init());
    ASSERT_TRUE(rig.on());
  }
  void want(const Frame& frame) { rig.set("xr", pose_of(frame)); }
};

TEST_F(PinvkinTest, StaysWithTheSolutionThatIsNearest) {
  ASSERT_TRUE(rig.cycle());
  for (std::size_t i = 0; i < 6; ++i) EXPECT_NEAR(rig.six("q_ref")[i], kBent[i], 1e-9);
}

TEST_F(PinvkinTest, StartsAtTheHandedOverCommandOrTheMeasurement) {
  for (std::size_t i = 0; i < 6; ++i) rig.set("q_ref", kBent[i] + 0.05, i);
  rig.inherit("q_ref", milliseconds(10));
  ASSERT_TRUE(rig.on());
  for (std::size_t i = 0; i < 6; ++i) EXPECT_EQ(rig.six("q_ref")[i], kBent[i] + 0.05);
  rig.inherit("q_ref", milliseconds(11));
  ASSERT_TRUE(rig.on());
  for (std::size_t i = 0; i < 6; ++i) EXPECT_EQ(rig.six("q_ref")[i], kBent[i]) << "an old command";
}

TEST_F(PinvkinTest, FollowsAPathWithoutChangingTheArm) {
  Puma560::Vector before = kBent;
  for (int step = 0; step < 1000; ++step) {
    Puma560::Vector goal = kBent;
    for (std::size_t i = 0; i < 6; ++i) goal[i] += 0.3 * std::sin(step * 0.005 + static_cast<double>(i));
    goal[4] = 0.5 + 0.4 * std::sin(step * 0.01);
    if (step == 0) {
      rig.give("q", goal);
      ASSERT_TRUE(rig.on());
      before = goal;
    }
    want(Puma560::forward(goal));
    ASSERT_TRUE(rig.cycle());
    const Puma560::Vector now = rig.six("q_ref");
    EXPECT_LT(distance(Puma560::forward(now), Puma560::forward(goal)), 1e-9);
    for (std::size_t i = 0; i < 6; ++i) ASSERT_LT(std::abs(now[i] - before[i]), 0.02) << "step " << step;
    before = now;
  }
}

TEST_F(PinvkinTest, AnUnreachableTargetKeepsTheReferenceAndIsReported) {
  ASSERT_TRUE(rig.cycle());
  const Puma560::Vector stands = rig.six("q_ref");
  Frame far = Puma560::forward(kBent);
  far.origin = {2, 0, 0};
  want(far);
  ASSERT_TRUE(rig.cycle());
  EXPECT_FALSE(rig.get<bool>("is_reachable"));
  EXPECT_EQ(rig.six("q_ref"), stands);
  want(Puma560::forward(kBent));
  ASSERT_TRUE(rig.cycle());
  EXPECT_TRUE(rig.get<bool>("is_reachable"));
}

TEST_F(PinvkinTest, ComesThroughTheSingularPosesOfThePuma) {
  const double elbow = -std::atan2(Puma560::d4, Puma560::a3);  // stretched arm, at the limit of its reach
  for (const Puma560::Vector& q : {Puma560::Vector{0.3, 0.8, -2.5, 0.4, 0, -0.2}, {0.3, 0.8, elbow, 0.4, 0.8, -0.2},
                                   {0.3, 0.8, elbow, 0.4, 0, -0.2}, {0, 0, 0, 0, 0, 0}}) {
    rig.give("q", q);
    ASSERT_TRUE(rig.on());
    want(Puma560::forward(q));
    ASSERT_TRUE(rig.cycle());
    EXPECT_TRUE(rig.get<bool>("is_reachable"));
    for (std::size_t i = 0; i < 6; ++i) EXPECT_NEAR(rig.six("q_ref")[i], q[i], 1e-5);
    EXPECT_LT(distance(Puma560::forward(rig.six("q_ref")), Puma560::forward(q)), 1e-7);
  }
}

TEST_F(PinvkinTest, RefusesAnInvalidPoseAndGoesOnAfterIt) {
  for (const Pose& bad : {Pose{{kNotANumber, 0, 0}, {1, 0, 0, 0}}, Pose{{0.5, 0, 0}, {0, 0, 0, 0}}}) {
    rig.set("xr", bad);
    EXPECT_EQ(rig.refusal(), "xr is not finite or no orientation");
  }
  want(Puma560::forward(kBent));
  EXPECT_EQ(rig.refusal(), "accepted");
  rig.set("q", kNotANumber, 1);
  EXPECT_EQ(rig.on().text, "q is not finite: no solution is near");
}

TEST_F(PinvkinTest, TheReferenceStandsWhileTheConfigurationIsIllegal) {
  EXPECT_TRUE(rig.stands_while_illegal("q_ref"));
}

}  // namespace
}  // namespace chimera::library
