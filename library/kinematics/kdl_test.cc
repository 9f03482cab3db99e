// SPDX-License-Identifier: Apache-2.0
// Compares kinematics with an independent implementation, Orocos KDL.
#include <gtest/gtest.h>

#include "library/kinematics/testing/kdl_proof.h"
#include "library/kinematics/puma560.h"
#include "library/kinematics/testing/random_arms.h"
#include "library/kinematics/singular_values.h"

namespace chimera::library {
namespace {

TEST(AgainstKdl, ForwardKinematicsAndJacobianOverAHundredThousandPosesOfAThousandArms) {
  RandomArms random;
  double farthest = 0;
  std::size_t judged = 0, near_singular = 0;
  for (std::size_t c = 0; c < 1000; ++c) {
    const DhChain chain = random.chain(1 + c % kMostJoints, c % 2 == 0);
    const SerialArm arm(chain);
    KdlArm kdl(chain);
    for (std::size_t p = 0; p < 100; ++p) {
      const Joints q = random.joints(p);
      Jacobian ours, theirs;
      kdl.solve(q);
      const Frame tool = arm.tool_frame(q, ours);
      farthest = std::max({farthest, difference(tool, kdl.tool_frame(theirs)), difference(ours, theirs, chain.ndof)});
      ++judged;
      if (p % 10 < 2 && c % 10 < 4 && SingularValues(ours, chain.ndof).least() < 1e-5) ++near_singular;
    }
  }
  EXPECT_EQ(judged, 100000u);
  EXPECT_GT(near_singular, 1000u);
  EXPECT_LT(farthest, 1e-12);
}

TEST(AgainstKdl, ThePumaInClosedForm) {
  RandomArms random;
  DhChain chain;
  chain.ndof = Puma560::kJoints;
  std::copy(Puma560::kRows.begin(), Puma560::kRows.end(), chain.dh.begin());
  KdlArm kdl(chain);
  double farthest = 0;
  for (std::size_t p = 0; p < 10000; ++p) {
    const Joints q = random.joints(p);
    Jacobian ours, theirs;
    kdl.solve(q);
    const Frame tool = Puma560::forward(std::span<const double, 6>(q.data(), 6), ours);
    farthest = std::max({farthest, difference(tool, kdl.tool_frame(theirs)), difference(ours, theirs, chain.ndof)});
  }
  EXPECT_LT(farthest, 1e-12);
}

// `./dev test --stress kinematics` runs these checks for a given time.
TEST(AgainstKdl, TheSeedsOfTheCampaign) {
  KdlTally tally;
  for (unsigned seed = 1; seed <= 300; ++seed) ASSERT_EQ(judge_kinematics(seed, tally), "");
  EXPECT_EQ(tally.poses, 6000u);
  EXPECT_GT(tally.inverses, 24000u);
  EXPECT_GT(10 * tally.solved, 8 * tally.searches);
}

}  // namespace
}  // namespace chimera::library
