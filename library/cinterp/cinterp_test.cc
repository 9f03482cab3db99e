// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include "library/kinematics/testing/arm_rig.h"

namespace chimera::library {
namespace {

constexpr Pose kHere{{0.5, 0.1, 0.3}, {1, 0, 0, 0}};

struct CinterpTest : ::testing::Test {
  ArmRig rig{"cinterp"};
  void SetUp() override {
    rig.set("xm", kHere);
    rig.set("xd", kHere);
    ASSERT_TRUE(rig.init());
    ASSERT_TRUE(rig.on());
  }
  Pose xr() { return rig.get<Pose>("xr"); }
  /// One cycle of an arm that follows without delay.
  Pose follow() {
    EXPECT_TRUE(rig.cycle());
    rig.set("xm", xr());
    return xr();
  }
};

TEST_F(CinterpTest, BeginsWhereTheToolIs) {
  for (std::size_t i = 0; i < 3; ++i) EXPECT_EQ(xr().position[i], kHere.position[i]);
}

TEST_F(CinterpTest, StartsAtTheHandedOverReference) {
  Pose ahead = kHere;
  ahead.position[1] += 0.03;
  rig.set("xr", ahead);
  rig.inherit("xr", milliseconds(2));
  ASSERT_TRUE(rig.on());
  EXPECT_EQ(xr().position[1], ahead.position[1]);
  rig.inherit("xr", milliseconds(20));
  ASSERT_TRUE(rig.on());
  EXPECT_EQ(xr().position[1], kHere.position[1]) << "an old reference";
  rig.set("xr", Pose{{0, kNotANumber, 0}, {1, 0, 0, 0}});
  rig.inherit("xr", milliseconds(2));
  ASSERT_TRUE(rig.on());
  EXPECT_EQ(xr().position[1], kHere.position[1]) << "no pose";
}

TEST_F(CinterpTest, MakesASmoothWayOfATargetThatJumps) {
  Pose goal{{0.9, -0.2, 0.3}, {std::cos(0.6), 0, std::sin(0.6), 0}};
  rig.set("xd", goal);
  Pose before = xr();
  for (int step = 0; step < 3000; ++step) {
    const Pose now = follow();
    const Vec3 way{now.position[0] - before.position[0], now.position[1] - before.position[1],
                   now.position[2] - before.position[2]};
    ASSERT_LE(length(way), 0.5 * 1e-3 + 1e-12);
    ASSERT_LE(angle_between(before.orientation, now.orientation), 1.0 * 1e-3 + 1e-9);
    before = now;
  }
  EXPECT_LT(distance(frame_of(before), frame_of(goal)), 1e-6);
}

TEST_F(CinterpTest, IsNoFartherFromTheToolThanItsLeash) {
  rig.set("xd", Pose{{2, 0.1, 0.3}, {1, 0, 0, 0}});
  for (int step = 0; step < 1000; ++step) ASSERT_TRUE(rig.cycle());  // an arm that does not move
  EXPECT_NEAR(xr().position[0], 0.6, 1e-12);
}

TEST_F(CinterpTest, AnOrientationAndItsNegativeAreTheSame) {
  rig.set("xd", Pose{{0.5, 0.1, 0.3}, {-1, 0, 0, 0}});
  follow();
  EXPECT_NEAR(angle_between(xr().orientation, kHere.orientation), 0, 1e-12);
}

TEST_F(CinterpTest, TurnsByHalfARevolutionToo) {
  const Pose goal{{0.5, 0.1, 0.3}, {0, 0, 0, 1}};
  rig.set("xd", goal);
  for (int step = 0; step < 5000; ++step) follow();
  EXPECT_LT(distance(frame_of(xr()), frame_of(goal)), 1e-6);
}

TEST_F(CinterpTest, StandsWithoutGainAndWhileTheConfigurationIsIllegal) {
  rig.set("xd", Pose{{0.9, 0.1, 0.3}, {1, 0, 0, 0}});
  rig.illegal(true);
  follow();
  EXPECT_EQ(xr().position[0], 0.5);
  rig.illegal(false);
  rig.set("gain", 0.0);
  follow();
  EXPECT_EQ(xr().position[0], 0.5);
}

TEST_F(CinterpTest, RefusesAnInvalidPoseAndGoesOnAfterIt) {
  rig.set("xd", Pose{{0, 0, 0}, {0, 0, 0, 0}});
  EXPECT_EQ(rig.refusal(), "a pose is not finite, or has no orientation");
  rig.set("xd", kHere);
  EXPECT_EQ(rig.refusal(), "accepted");
  rig.set("xm", Pose{{kNotANumber, 0, 0}, {1, 0, 0, 0}});
  EXPECT_EQ(rig.refusal(), "a pose is not finite, or has no orientation");
  EXPECT_EQ(rig.on().text, "xm is not finite or no orientation: xr cannot begin there");
}

}  // namespace
}  // namespace chimera::library
