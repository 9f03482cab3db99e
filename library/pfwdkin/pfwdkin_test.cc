// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include "library/kinematics/testing/arm_rig.h"

namespace chimera::library {
namespace {

TEST(Pfwdkin, IsTheFlangeOfThePublishedPoses) {
  // Place of the wrist centre (Corke and Armstrong-Helouvry 1994). The flange is before it along the z axis of the
  // hand.
  struct Published {
    Puma560::Vector q;
    Vec3 wrist, z;
  };
  constexpr double kRight = std::numbers::pi / 2;
  const Published poses[] = {{{0, 0, 0, 0, 0, 0}, {.4521, -.15005, .4318}, {0, 0, 1}},
                             {{0, kRight, -kRight, 0, 0, 0}, {.0203, -.15005, .8636}, {0, 0, 1}},
                             {{0, 0, -kRight, 0, 0, 0}, {.8636, -.15005, -.0203}, {1, 0, 0}},
                             {{0, kRight / 2, 2 * kRight, 0, kRight / 2, 0}, {.5963, -.15005, -.01435}, {1, 0, 0}}};
  ArmRig rig("pfwdkin");
  for (const Published& pose : poses) {
    rig.give("q", pose.q);
    ASSERT_TRUE(rig.cycle());
    const Frame found = rig.pose("xm");
    EXPECT_LT(length(found.origin - Puma560::d6 * found.z - pose.wrist), 5e-5);
    EXPECT_LT(length(found.z - pose.z), 1e-9);
  }
}

TEST(Pfwdkin, RefusesAJointThatIsNotFiniteAndGoesOnAfterIt) {
  ArmRig rig("pfwdkin");
  rig.give("q", kBent);
  ASSERT_TRUE(rig.on());
  rig.set("q", kNotANumber, 5);
  EXPECT_EQ(rig.refusal(), "q is not finite");
  rig.give("q", kBent);
  EXPECT_EQ(rig.refusal(), "accepted");
}

}  // namespace
}  // namespace chimera::library
