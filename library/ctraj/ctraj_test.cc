// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include "library/kinematics/testing/arm_rig.h"

namespace chimera::library {
namespace {

struct CtrajTest : ::testing::Test {
  ArmRig rig{"ctraj"};
  void SetUp() override {
    rig.set("centre", Pose{{0.5, 0, 0.3}, {0.6, 0, 0.8, 0}});
    const double amplitude[] = {0.1, 0.2, 0}, frequency[] = {0.5, 1, 3}, phase[] = {0, std::numbers::pi / 2, 0};
    rig.give("amplitude", amplitude);
    rig.give("frequency", frequency);
    rig.give("phase", phase);
  }
};

TEST_F(CtrajTest, GoesRoundItsFigureFromOn) {
  ASSERT_TRUE(rig.init());
  ASSERT_TRUE(rig.on());
  EXPECT_NEAR(rig.get<Pose>("xd").position[1], 0.2, 1e-15);
  for (int step = 0; step < 50; ++step) ASSERT_TRUE(rig.cycle(milliseconds(10)));
  const Pose half = rig.get<Pose>("xd");
  EXPECT_NEAR(half.position[0], 0.6, 1e-9);
  EXPECT_NEAR(half.position[1], -0.2, 1e-9);
  EXPECT_EQ(half.position[2], 0.3);
  EXPECT_EQ(half.orientation[2], 0.8);
}

TEST_F(CtrajTest, RefusesACentreWithoutOrientation) {
  rig.set("centre", Pose{{0.5, 0, 0.3}, {0, 0, 0, 0}});
  EXPECT_EQ(rig.refusal(), "centre: not finite, or the orientation is no unit quaternion");
}

TEST_F(CtrajTest, RefusesAPhaseThatIsNotFinite) {
  rig.set("phase", kNotANumber, 2);
  EXPECT_EQ(rig.refusal(), "phase: a number is not finite");
}

}  // namespace
}  // namespace chimera::library
