// SPDX-License-Identifier: Apache-2.0
#include "library/kinematics/serial_arm.h"

#include <gtest/gtest.h>

#include <random>
#include <vector>

#include "library/kinematics/puma560.h"

namespace chimera::library {
namespace {

constexpr double kPi = std::numbers::pi;

DhChain puma() {
  DhChain chain;
  chain.ndof = 6;
  std::copy(Puma560::kRows.begin(), Puma560::kRows.end(), chain.dh.begin());
  return chain;
}

double apart(const Frame& a, const Frame& b) {
  const Six e = motion_between(a, b);
  return std::max(length({e[0], e[1], e[2]}), length({e[3], e[4], e[5]}));
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
  const DhChain chain = puma();
  RandomJoints joints;
  constexpr double h = 1e-6;
  for (int trial = 0; trial < 200; ++trial) {
    Puma560::Vector q = joints.next();
    Jacobian jacobian;
    const Frame here = tool_frame(chain, q, jacobian);
    for (std::size_t i = 0; i < 6; ++i) {
      Puma560::Vector moved = q;
      moved[i] += h;
      const Six slope = motion_between(here, tool_frame(chain, moved));
      for (std::size_t r = 0; r < 6; ++r) EXPECT_NEAR(DampedInverse::element(jacobian, r, i), slope[r] / h, 1e-5);
    }
  }
}

TEST(SerialArm, TurnsAreFoundUpToHalfARevolution) {
  const Frame start;
  for (const double angle : {0.0, 1e-12, 1e-6, 0.3, 3.0, kPi - 1e-9, kPi}) {
    const Frame turned = frame_of(DhLink{0, angle, 0, 0}, 0);
    const Triple found = turn_between(start, turned);
    EXPECT_NEAR(std::abs(found[0]), angle, 2e-8) << angle;
    EXPECT_NEAR(found[1], 0, 1e-8);
  }
}

TEST(DampedInverse, IsTheInverseFarFromSingularPoses) {
  const DhChain chain = puma();
  const Puma560::Vector q{0.3, 0.8, -2.5, 0.4, 0.8, -0.2};
  Jacobian jacobian;
  tool_frame(chain, q, jacobian);
  DampedInverse inverse;
  const Six wanted{0.1, -0.2, 0.05, 0.3, 0.1, -0.4};
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
  const DhChain chain = puma();
  const Puma560::Vector singular[] = {{0, 0, 0, 0, 0, 0}, {0, kPi / 2, -kPi / 2, 0, 0, 0}, {0, 0, -kPi / 2, 0, 1e-7, 0},
                                      {0, kPi / 4, -kPi, 0, 1e-3, 0}};
  for (const Puma560::Vector& q : singular) {
    Jacobian jacobian;
    tool_frame(chain, q, jacobian);
    DampedInverse inverse;
    Puma560::Vector dq;
    inverse.solve(jacobian, 6, {1, 1, 1, 1, 1, 1}, dq);
    EXPECT_LT(inverse.manipulability(), 1e-2);
    for (double speed : dq) EXPECT_LT(std::abs(speed), 60);
  }
}

TEST(PoseSearch, FollowsAPathAwayFromSingularPoses) {
  const DhChain chain = puma();
  RandomJoints joints;
  PoseSearch search;
  int tried = 0;
  for (int trial = 0; trial < 2000; ++trial) {
    const Puma560::Vector goal = joints.next();
    Jacobian jacobian;
    const Frame wanted = tool_frame(chain, goal, jacobian);
    DampedInverse inverse;
    Puma560::Vector q = goal, dq;
    inverse.solve(jacobian, 6, Six{}, dq);
    if (inverse.manipulability() < 0.03) continue;
    ++tried;
    for (double& angle : q) angle += 0.02;
    EXPECT_TRUE(search.solve(chain, wanted, q, 1e-6)) << "trial " << trial << ", residual " << search.residual();
  }
  EXPECT_GT(tried, 500);
}

TEST(PoseSearch, EndsNearAPoseThatIsOutOfReach) {
  const DhChain chain = puma();
  Puma560::Vector q{0.3, 0.8, -2.5, 0.4, 0.8, -0.2};
  Frame far = tool_frame(chain, q);
  far.origin = {3, 0, 0};
  PoseSearch search;
  EXPECT_FALSE(search.solve(chain, far, q, 1e-6));
  EXPECT_GT(search.residual(), 1.5);
  for (double angle : q) EXPECT_TRUE(std::isfinite(angle));
}

TEST(Puma560, ForwardIsTheGeneralOne) {
  const DhChain chain = puma();
  RandomJoints joints;
  for (int trial = 0; trial < 20000; ++trial) {
    const Puma560::Vector q = joints.next();
    ASSERT_LT(apart(Puma560::forward(q), tool_frame(chain, q)), 1e-12);
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
    for (std::size_t s = 0; s < all.count; ++s) ASSERT_LT(apart(Puma560::forward(all.q[s]), wanted), 1e-9);
    Puma560::Vector found;
    ASSERT_TRUE(Puma560::nearest(wanted, q, found));
    for (std::size_t i = 0; i < 6; ++i) ASSERT_NEAR(found[i], q[i], 1e-6) << "trial " << trial << " joint " << i + 1;
  }
  EXPECT_GT(eight, 10000u);
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
