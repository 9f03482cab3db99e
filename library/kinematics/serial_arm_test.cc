// SPDX-License-Identifier: Apache-2.0
#include "library/kinematics/serial_arm.h"

#include <gtest/gtest.h>

#include <random>
#include <vector>

#include "chimera/base/math.h"
#include "library/kinematics/testing/arm_rig.h"
#include "library/kinematics/puma560.h"

namespace chimera::library {
namespace {

SerialArm puma() {
  DhChain chain;
  chain.ndof = 6;
  std::copy(Puma560::kRows.begin(), Puma560::kRows.end(), chain.dh.begin());
  return SerialArm(chain);
}

struct RandomJoints {
  std::mt19937 random{11};
  Puma560::Vector next() {
    Puma560::Vector q;
    for (std::size_t i = 0; i < 6; ++i) {
      q[i] = std::uniform_real_distribution<double>(Puma560::kLow[i], Puma560::kHigh[i])(random);
    }
    return q;
  }
};

TEST(SerialArm, JacobianIsTheSlopeOfTheForwardKinematics) {
  const SerialArm arm = puma();
  RandomJoints joints;
  constexpr double h = 1e-6;
  for (int trial = 0; trial < 200; ++trial) {
    Puma560::Vector q = joints.next();
    Jacobian jacobian;
    const Frame here = arm.tool_frame(q, jacobian);
    for (std::size_t i = 0; i < 6; ++i) {
      Puma560::Vector moved = q;
      moved[i] += h;
      const Vec6 slope = motion_between(here, arm.tool_frame(moved));
      for (std::size_t r = 0; r < 6; ++r) EXPECT_NEAR(DampedInverse::element(jacobian, r, i), slope[r] / h, 1e-5);
    }
  }
}

TEST(SerialArm, TurnsAreFoundUpToHalfARevolution) {
  const Frame start;
  for (const double angle : {0.0, 1e-12, 1e-6, 0.3, 3.0, math::kPi - 1e-9, math::kPi}) {
    const Frame turned = frame_of(DhLink{0, angle, 0, 0}, 0);
    const Vec3 found = turn_between(start, turned);
    EXPECT_NEAR(std::abs(found[0]), angle, 2e-8) << angle;
    EXPECT_NEAR(found[1], 0, 1e-8);
  }
}

TEST(DampedInverse, IsTheInverseFarFromSingularPoses) {
  const SerialArm arm = puma();
  const Puma560::Vector q{0.3, 0.8, -2.5, 0.4, 0.8, -0.2};
  Jacobian jacobian;
  arm.tool_frame(q, jacobian);
  DampedInverse inverse;
  const Vec6 wanted{0.1, -0.2, 0.05, 0.3, 0.1, -0.4};
  Puma560::Vector dq;
  inverse.solve(jacobian, 6, wanted, dq);
  ASSERT_GT(inverse.manipulability(), 0.02);
  for (std::size_t r = 0; r < 6; ++r) {
    double sum = 0;
    for (std::size_t i = 0; i < 6; ++i) sum += DampedInverse::element(jacobian, r, i) * dq[i];
    EXPECT_NEAR(sum, wanted[r], 1e-6);
  }
}

TEST(DampedInverse, StaysBoundedAtSingularPoses) {
  const SerialArm arm = puma();
  const Puma560::Vector singular[] = {{0, 0, 0, 0, 0, 0}, {0, math::kPi / 2, -math::kPi / 2, 0, 0, 0},
                                      {0, 0, -math::kPi / 2, 0, 1e-7, 0}, {0, math::kPi / 4, -math::kPi, 0, 1e-3, 0}};
  for (const Puma560::Vector& q : singular) {
    Jacobian jacobian;
    arm.tool_frame(q, jacobian);
    DampedInverse inverse;
    Puma560::Vector dq;
    inverse.solve(jacobian, 6, {1, 1, 1, 1, 1, 1}, dq);
    EXPECT_LT(inverse.manipulability(), 1e-2);
    for (double speed : dq) EXPECT_LT(std::abs(speed), 60);
  }
}

TEST(PoseSearch, FollowsAPathAwayFromSingularPoses) {
  const SerialArm arm = puma();
  RandomJoints joints;
  PoseSearch search;
  int tried = 0;
  for (int trial = 0; trial < 2000; ++trial) {
    const Puma560::Vector goal = joints.next();
    Jacobian jacobian;
    const Frame wanted = arm.tool_frame(goal, jacobian);
    DampedInverse inverse;
    Puma560::Vector q = goal, dq;
    inverse.solve(jacobian, 6, Vec6{}, dq);
    if (inverse.manipulability() < 0.03) continue;
    ++tried;
    for (double& angle : q) angle += 0.02;
    EXPECT_TRUE(search.solve(arm, wanted, q, 1e-6)) << "trial " << trial << ", residual " << search.residual();
  }
  EXPECT_GT(tried, 500);
}

TEST(PoseSearch, EndsNearAPoseThatIsOutOfReach) {
  const SerialArm arm = puma();
  Puma560::Vector q{0.3, 0.8, -2.5, 0.4, 0.8, -0.2};
  Frame far = arm.tool_frame(q);
  far.origin = {3, 0, 0};
  PoseSearch search;
  EXPECT_FALSE(search.solve(arm, far, q, 1e-6));
  EXPECT_EQ(search.steps(), PoseSearch::kMostSteps);
  EXPECT_GT(search.residual(), 1.5);
  for (double angle : q) EXPECT_TRUE(std::isfinite(angle));
}

TEST(PoseSearch, TakesNoMoreStepsThanItsBound) {
  const SerialArm arm = puma();
  RandomJoints joints;
  PoseSearch search;
  Puma560::Vector q = joints.next();
  int longest = 0, shortest = PoseSearch::kMostSteps;
  for (int trial = 0; trial < 5000; ++trial) {
    if (trial % 3 == 0) q = joints.next();
    if (trial % 30 == 0) q = {0, 0, 0, 0, 0, 0};
    search.solve(arm, arm.tool_frame(trial % 7 == 0 ? q : joints.next()), q, 1e-6);
    longest = std::max(longest, search.steps());
    shortest = std::min(shortest, search.steps());
    for (double angle : q) ASSERT_TRUE(std::isfinite(angle));
  }
  EXPECT_EQ(longest, PoseSearch::kMostSteps);
  EXPECT_EQ(shortest, 0);
}

TEST(Puma560, ForwardIsTheGeneralOne) {
  const SerialArm arm = puma();
  RandomJoints joints;
  for (int trial = 0; trial < 20000; ++trial) {
    const Puma560::Vector q = joints.next();
    ASSERT_LT(distance(Puma560::forward(q), arm.tool_frame(q)), 1e-12);
  }
}

TEST(Puma560, EveryInverseSolutionReachesThePoseAndOneIsWhereWeCameFrom) {
  RandomJoints joints;
  std::size_t eight = 0;
  for (int trial = 0; trial < 20000; ++trial) {
    const Puma560::Vector q = joints.next();
    const Frame wanted = Puma560::forward(q);
    const Puma560::Solutions all = Puma560::inverse(wanted, q);
    ASSERT_GE(all.count, 4u);
    if (all.count == 8) ++eight;
    for (std::size_t s = 0; s < all.count; ++s) ASSERT_LT(distance(Puma560::forward(all.q[s]), wanted), 1e-9);
    Puma560::Vector found;
    ASSERT_TRUE(Puma560::nearest(wanted, q, found));
    for (std::size_t i = 0; i < 6; ++i) ASSERT_NEAR(found[i], q[i], 1e-6) << "trial " << trial << " joint " << i + 1;
  }
  EXPECT_GT(eight, 10000u);
}

TEST(Puma560, ThePosesOfAnArmThatIsNotSingularHaveEightDifferentSolutions) {
  RandomJoints joints;
  for (int trial = 0; trial < 2000; ++trial) {
    Puma560::Vector q = joints.next();
    q[1] = -0.2, q[2] = -2.4;  // wrist beside and above the shoulder: both elbows and both arms reach it
    if (std::abs(q[4]) < 0.1) continue;
    const Puma560::Solutions all = Puma560::inverse(Puma560::forward(q), q);
    ASSERT_EQ(all.count, 8u);
    for (std::size_t s = 0; s < 8; ++s) {
      for (std::size_t t = 0; t < s; ++t) {
        double differs = 0;
        for (std::size_t i = 0; i < 6; ++i) {
          differs = std::max(differs, std::abs(std::remainder(all.q[s][i] - all.q[t][i], 2 * math::kPi)));
        }
        ASSERT_GT(differs, 0.05) << s << " and " << t;
      }
    }
  }
}

TEST(Puma560, SingularPosesAreReachedToo) {
  RandomJoints joints;
  std::uniform_real_distribution<double> little(-1e-6, 1e-6);
  for (int trial = 0; trial < 20000; ++trial) {
    Puma560::Vector q = joints.next();
    const double size = trial % 2 == 0 ? 0 : 1;
    if ((trial / 2) % 3 != 1) q[4] = size * little(joints.random);                                          // wrist
    if ((trial / 2) % 3 != 0) q[2] = -std::atan2(Puma560::d4, Puma560::a3) + size * little(joints.random);  // elbow
    for (double& angle : q) angle *= 0.8;  // away from the limits, because the ratio of q4 to q6 is lost
    q[2] /= 0.8;
    const Frame wanted = Puma560::forward(q);
    Puma560::Vector found;
    ASSERT_TRUE(Puma560::nearest(wanted, q, found));
    ASSERT_LT(distance(Puma560::forward(found), wanted), 3e-7) << "trial " << trial;
    for (std::size_t i = 0; i < 6; ++i) ASSERT_NEAR(found[i], q[i], i == 3 || i == 5 ? 1.0 : 1e-5) << "trial " << trial;
  }
}

TEST(Puma560, AStretchedWristKeepsItsFourthJoint) {
  const Puma560::Vector q{0.4, 0.7, -1.9, 0.9, 0, -0.3};
  Puma560::Vector found;
  ASSERT_TRUE(Puma560::nearest(Puma560::forward(q), q, found));
  for (std::size_t i = 0; i < 6; ++i) EXPECT_NEAR(found[i], q[i], 1e-6);
}

TEST(Puma560, HasNoSolutionOutOfReachOrBehindTheShoulderAxis) {
  Frame far;
  far.origin = {2, 0, 0};
  Puma560::Vector q{}, found{9};
  EXPECT_FALSE(Puma560::nearest(far, q, found));
  EXPECT_EQ(found[0], 9);
  far.origin = {0.05, 0, 0.5};
  EXPECT_FALSE(Puma560::nearest(far, q, found));
}

}  // namespace
}  // namespace chimera::library
