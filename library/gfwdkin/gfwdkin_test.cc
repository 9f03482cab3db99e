// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include "library/kinematics/testing/arm_rig.h"

namespace chimera::library {
namespace {

struct GfwdkinTest : ::testing::Test {
  ArmRig rig{"gfwdkin"};
  void SetUp() override {
    rig.build_puma();
    rig.give("q", kBent);
  }
};

TEST_F(GfwdkinTest, PublishesThePoseOfTheToolFromOn) {
  ASSERT_TRUE(rig.init());
  ASSERT_TRUE(rig.on());
  EXPECT_LT(distance(rig.pose("xm"), Puma560::forward(kBent)), 1e-12);
}

TEST_F(GfwdkinTest, BaseAndToolAreBeforeAndBehindTheRows) {
  const Pose base{{1, 2, 3}, {0.6, 0, 0, 0.8}}, tool{{0.1, 0, 0.2}, {0.8, 0.6, 0, 0}};
  rig.set("base", base);
  rig.set("tool", tool);
  ASSERT_TRUE(rig.init());
  ASSERT_TRUE(rig.cycle());
  EXPECT_LT(distance(rig.pose("xm"), frame_of(base) * Puma560::forward(kBent) * frame_of(tool)), 1e-12);
}

TEST_F(GfwdkinTest, TakesAnotherToolByReinit) {
  ASSERT_TRUE(rig.init());
  ASSERT_TRUE(rig.cycle());
  rig.set("tool", Pose{{0, 0, 0.3}, {1, 0, 0, 0}});
  ASSERT_TRUE(rig.reinit());
  ASSERT_TRUE(rig.cycle());
  const Frame flange = Puma560::forward(kBent);
  EXPECT_LT(length(rig.pose("xm").origin - (flange.origin + 0.3 * flange.z)), 1e-12);
}

TEST_F(GfwdkinTest, RefusesAJointThatIsNotFiniteAndGoesOnAfterIt) {
  for (const double bad : {kNotANumber, HUGE_VAL}) {
    rig.set("q", bad, 4);
    EXPECT_EQ(rig.refusal(), "q is not finite");
    EXPECT_FALSE(rig.on());
  }
  rig.give("q", kBent);
  EXPECT_EQ(rig.refusal(), "accepted");
}

TEST_F(GfwdkinTest, RefusesConstantsThatAreNoArm) {
  rig.set("dh", DhLink{0, kNotANumber, 0, 0}, 2);
  EXPECT_EQ(rig.refusal(), "dh: a number is not finite");
  rig.build_puma();
  rig.set("base", Pose{{0, 0, 0}, {0, 0, 0, 0}});
  EXPECT_EQ(rig.refusal(), "base: not finite, or the orientation is no unit quaternion");
  rig.set("base", kIdentityPose);
  rig.set("tool", Pose{{HUGE_VAL, 0, 0}, {1, 0, 0, 0}});
  EXPECT_EQ(rig.refusal(), "tool: not finite, or the orientation is no unit quaternion");
}

}  // namespace
}  // namespace chimera::library
