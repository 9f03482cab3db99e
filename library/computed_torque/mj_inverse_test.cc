// SPDX-License-Identifier: Apache-2.0
// Compares ArmDynamics with an independent implementation: MuJoCo's inverse dynamics of the same arms, as MJCF.
#include <gtest/gtest.h>

#include "library/mujoco/testing/random_arm.h"

namespace chimera::library {
namespace {

TEST(ArmDynamics, IsMujocosInverseDynamicsForRandomArms) {
  std::mt19937 random(1980);
  const auto vector = [&random](double most) {
    Joints made;
    for (double& part : made) part = std::uniform_real_distribution<double>(-most, most)(random);
    return made;
  };
  double farthest = 0, largest = 0;
  for (std::size_t a = 0; a < 30; ++a) {
    const RandomArm arm(random, 1 + a % kMostJoints);
    const ArmDynamics dynamics(arm.chain, arm.links, {1, 2, -9}, arm.payload);
    MujocoArm mujoco(arm.mjcf());
    ASSERT_TRUE(mujoco.state);
    for (std::size_t pose = 0; pose < 100; ++pose) {
      const Joints q = vector(3.1), qd = vector(4), qdd = vector(20);
      Joints ours{};
      dynamics.torque(q, qd, qdd, ours);
      const double* theirs = mujoco.torque(q, qd, qdd);
      for (std::size_t i = 0; i < arm.chain.ndof; ++i) {
        farthest = std::max(farthest, std::abs(ours[i] - theirs[i]));
        largest = std::max(largest, std::abs(theirs[i]));
      }
    }
  }
  EXPECT_GT(largest, 1000);
  EXPECT_LT(farthest / largest, 1e-12);
}

}  // namespace
}  // namespace chimera::library
