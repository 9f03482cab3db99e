// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include "library/kinematics/testing/arm_rig.h"

namespace chimera::library {
namespace {

TEST(FwdkinJacobian, PublishesThePoseOfTheToolAndItsMotionWithEachJoint) {
  ArmRig rig("fwdkin_jacobian");
  rig.build_puma();
  rig.give("q", kBent);
  ASSERT_TRUE(rig.init());
  ASSERT_TRUE(rig.on());
  Jacobian expected;
  EXPECT_LT(distance(rig.pose("xm"), Puma560::forward(kBent, expected)), 1e-12);
  for (std::size_t i = 0; i < 6; ++i) {
    for (std::size_t r = 0; r < 3; ++r) {
      EXPECT_NEAR(rig.get<double>("jv", 6 * r + i), expected.linear[i][r], 1e-12);
      EXPECT_NEAR(rig.get<double>("jw", 6 * r + i), expected.angular[i][r], 1e-12);
    }
  }
}

TEST(FwdkinJacobian, ASingularArmHasAJacobianLikeAnyOther) {
  ArmRig rig("fwdkin_jacobian");
  rig.build_puma();
  rig.give("q", Puma560::Vector{});
  ASSERT_TRUE(rig.init());
  ASSERT_TRUE(rig.cycle());
  for (std::size_t r = 0; r < 3; ++r) {
    EXPECT_NEAR(rig.get<double>("jw", 6 * r + 3), rig.get<double>("jw", 6 * r + 5), 1e-15);
  }
}

TEST(FwdkinJacobian, RefusesAJointThatIsNotFiniteAndWrongConstants) {
  ArmRig rig("fwdkin_jacobian");
  rig.build_puma();
  rig.set("q", kNotANumber, 0);
  EXPECT_EQ(rig.refusal(), "q is not finite");
  rig.set("dh", DhLink{HUGE_VAL, 0, 0, 0}, 5);
  EXPECT_EQ(rig.refusal(), "dh: a number is not finite");
}

}  // namespace
}  // namespace chimera::library
