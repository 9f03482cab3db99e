// SPDX-License-Identifier: Apache-2.0
// Against a reference that nobody here wrote: Orocos KDL.
#include <gtest/gtest.h>

#include <numbers>
#include <random>

#include "library/kinematics/kdl_oracle.h"

namespace chimera::library {
namespace {

struct RandomChains {
  std::mt19937 random{2026};
  double metre() { return std::uniform_real_distribution<double>(-0.5, 0.5)(random); }
  double rad() { return std::uniform_real_distribution<double>(-std::numbers::pi, std::numbers::pi)(random); }
  double right_angle() { return std::uniform_int_distribution<int>(-2, 2)(random) * std::numbers::pi / 2; }

  /// A plain one has right angles and lengths of 0, as real arms have: singular poses are among those of its joints.
  DhChain chain(std::size_t joints, bool plain) {
    DhChain made;
    made.ndof = joints;
    for (std::size_t i = 0; i < joints; ++i) {
      made.dh[i] = {plain && i % 3 == 0 ? 0 : metre(), plain ? right_angle() : rad(), plain && i % 2 == 0 ? 0 : metre(),
                    plain ? right_angle() : rad()};
    }
    return made;
  }
  std::vector<ArmPose> poses(std::size_t count) {
    std::vector<ArmPose> made(count);
    for (std::size_t p = 0; p < count; ++p) {
      for (double& angle : made[p].q) angle = p % 10 == 0 ? right_angle() : rad();
    }
    return made;
  }
};

double apart(const Triple& a, const Triple& b) { return length(a - b); }

TEST(AgainstKdl, ForwardKinematicsAndJacobianOverAHundredThousandPoses) {
  RandomChains random;
  double farthest = 0;
  std::size_t judged = 0;
  for (std::size_t c = 0; c < 1000; ++c) {
    const DhChain chain = random.chain(1 + c % kMostJoints, c % 2 == 0);
    std::vector<ArmPose> poses = random.poses(100);
    ask_kdl(chain, poses);
    for (const ArmPose& expected : poses) {
      Jacobian jacobian;
      const Frame tool = tool_frame(chain, expected.q, jacobian);
      farthest = std::max({farthest, apart(tool.origin, expected.tool.origin), apart(tool.x, expected.tool.x),
                           apart(tool.y, expected.tool.y), apart(tool.z, expected.tool.z)});
      for (std::size_t i = 0; i < chain.ndof; ++i) {
        farthest = std::max({farthest, apart(jacobian.linear[i], expected.jacobian.linear[i]),
                             apart(jacobian.angular[i], expected.jacobian.angular[i])});
      }
      ++judged;
    }
  }
  EXPECT_EQ(judged, 100000u);
  EXPECT_LT(farthest, 1e-12);
}

}  // namespace
}  // namespace chimera::library
