// SPDX-License-Identifier: Apache-2.0
#include "library/mujoco/link_masses.h"

#include "library/mujoco/testing/random_arm.h"

namespace chimera::library {
namespace {

Joints random_joints(std::mt19937& random, double most) {
  Joints made;
  for (double& part : made) part = std::uniform_real_distribution<double>(-most, most)(random);
  return made;
}

// Rows and masses read from the model give the torques that MuJoCo computes.
TEST(LinkMasses, GiveTheInverseDynamicsOfMujoco) {
  std::mt19937 random(560);
  double farthest = 0, largest = 0;
  for (std::size_t a = 0; a < 30; ++a) {
    const RandomArm told(random, 1 + a % kMostJoints);
    MujocoArm mujoco(told.mjcf());
    ASSERT_TRUE(mujoco.state);
    const Result<ArmModel> arm = find_arm(mujoco.model.get(), mujoco.state.get(), "");
    ASSERT_TRUE(arm);
    ASSERT_EQ(arm->ndof, told.chain.ndof);
    const auto links = link_masses(mujoco.model.get(), mujoco.state.get(), *arm);
    const ArmDynamics dynamics(arm->chain, links, {1, 2, -9}, 0);  // the payload is a part of the last link
    for (std::size_t pose = 0; pose < 50; ++pose) {
      const Joints q = random_joints(random, 3.1), qd = random_joints(random, 4), qdd = random_joints(random, 20);
      Joints ours{};
      dynamics.torque(q, qd, qdd, ours);
      const double* theirs = mujoco.torque(q, qd, qdd);
      for (std::size_t i = 0; i < arm->ndof; ++i) {
        farthest = std::max(farthest, std::abs(ours[i] - theirs[i]));
        largest = std::max(largest, std::abs(theirs[i]));
      }
    }
  }
  EXPECT_GT(largest, 1000);
  EXPECT_LT(farthest / largest, 1e-11);
}

TEST(LinkMasses, IncludeBodiesThatSlideOnALinkButNotTheScenery) {
  MujocoArm mujoco(R"(<mujoco><worldbody>
    <body><joint axis="0 0 1" armature="0.3" damping="2"/>
      <inertial pos="0.5 0 0" mass="2" diaginertia="0.1 0.2 0.2"/>
      <body pos="1 0 0"><joint type="slide" axis="1 0 0"/>
        <inertial pos="0 0 0" mass="1" diaginertia="1e-9 1e-9 1e-9"/></body>
    </body>
    <body pos="3 0 0"><freejoint/><inertial pos="0 0 0" mass="50" diaginertia="1 1 1"/></body>
    </worldbody></mujoco>)");
  ASSERT_TRUE(mujoco.state);
  const Result<ArmModel> arm = find_arm(mujoco.model.get(), mujoco.state.get(), "");
  ASSERT_TRUE(arm);
  const auto links = link_masses(mujoco.model.get(), mujoco.state.get(), *arm);
  EXPECT_EQ(links[0].mass, 3);
  EXPECT_NEAR(links[0].centre[0], 2.0 / 3, 1e-12);
  EXPECT_NEAR(links[0].inertia[2], 0.2 + 2.0 / 3 * 0.25, 1e-8);
  EXPECT_EQ(links[0].rotor, 0.3);
  EXPECT_EQ(links[0].friction, 2);
  EXPECT_EQ(links[1].mass, 0);
}

}  // namespace
}  // namespace chimera::library
