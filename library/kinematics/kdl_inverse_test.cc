// SPDX-License-Identifier: Apache-2.0
// Compares the inverse solvers with an independent implementation, Orocos KDL: KDL finds the tool where a solver says,
// or the solver reports that the pose is out of reach.
#include <gtest/gtest.h>

#include "library/kinematics/puma560.h"
#include "library/kinematics/testing/random_arms.h"

namespace chimera::library {
namespace {

constexpr double kAgreed = 1e-9;  // m and rad

struct InverseAgainstKdl : ::testing::Test {
  RandomArms random;

  // `--gtest_shuffle --gtest_repeat=10` gives other poses.
  void SetUp() override {
    const unsigned seed = 2026 + static_cast<unsigned>(::testing::UnitTest::GetInstance()->random_seed());
    random.random.seed(seed);
    RecordProperty("seed", static_cast<int>(seed));
  }
  static DhChain puma() {
    DhChain chain;
    chain.ndof = Puma560::kJoints;
    std::copy(Puma560::kRows.begin(), Puma560::kRows.end(), chain.dh.begin());
    return chain;
  }
  static Frame forward(KdlArm& kdl, std::span<const double> q) {
    Jacobian unused;
    kdl.solve(q);
    return kdl.tool_frame(unused);
  }
  static std::span<const double, 6> six(const Joints& q) { return std::span<const double, 6>(q.data(), 6); }
  /// Joint positions within the limits. The wrist is stretched in each tenth, and nearly stretched in the next.
  Joints within_limits(std::size_t pose) {
    Joints q{};
    for (std::size_t i = 0; i < 6; ++i) q[i] = within(Puma560::kLow[i], Puma560::kHigh[i]);
    if (pose % 10 < 2) q[4] = pose % 10 == 0 ? 0 : within(-1e-6, 1e-6);
    return q;
  }
  double within(double least, double most) { return random.within(least, most); }
};

TEST_F(InverseAgainstKdl, EachOfTheEightClosedFormsLeadsBackOverAHundredThousandPoses) {
  KdlArm kdl(puma());
  double farthest = 0;
  std::size_t solutions = 0, eight = 0;
  for (std::size_t p = 0; p < 100000; ++p) {
    const Joints q = random.joints(p);
    const Frame wanted = forward(kdl, q);
    const Puma560::Solutions found = Puma560::inverse(wanted, six(q));
    ASSERT_GT(found.count, 0u) << p;
    for (std::size_t s = 0; s < found.count; s += p % 5 == 0 ? 1 : found.count - 1) {
      farthest = std::max(farthest, difference(forward(kdl, found.q[s]), wanted));
      ++solutions;
    }
    eight += found.count == 8;
  }
  EXPECT_LT(farthest, kAgreed);
  EXPECT_GT(eight, 30000u);
  EXPECT_GT(solutions, 250000u);
}

TEST_F(InverseAgainstKdl, WhereElbowAndWristAreStretchedAtOnceTheToolIsWithinATenthOfAMicrometre) {
  KdlArm kdl(puma());
  const double stretched = -std::atan2(Puma560::d4, Puma560::a3);
  for (std::size_t p = 0; p < 2000; ++p) {
    Joints q = within_limits(p % 2);
    q[2] = stretched + (p % 4 < 2 ? 0 : within(-1e-6, 1e-6));
    const Frame wanted = forward(kdl, q);
    const Puma560::Solutions found = Puma560::inverse(wanted, six(q));
    ASSERT_GT(found.count, 0u);
    for (std::size_t s = 0; s < found.count; ++s) ASSERT_LT(difference(forward(kdl, found.q[s]), wanted), 3e-7);
  }
}

TEST_F(InverseAgainstKdl, TheNearestSolutionIsWithinTheLimitsAndNeverMissing) {
  KdlArm kdl(puma());
  double farthest = 0;
  for (std::size_t p = 0; p < 20000; ++p) {
    const Joints q = within_limits(p);
    Joints near = q, chosen{};
    double off = 0;
    for (std::size_t i = 0; i < 6; ++i) near[i] = within(q[i] - 0.1, q[i] + 0.1);
    for (std::size_t i = 0; i < 6; ++i) off = std::max(off, std::abs(near[i] - q[i]));
    const Frame wanted = forward(kdl, q);
    ASSERT_TRUE(Puma560::nearest(wanted, six(near), std::span<double, 6>(chosen.data(), 6))) << p;
    farthest = std::max(farthest, difference(forward(kdl, chosen), wanted));
    for (std::size_t i = 0; i < 6; ++i) {
      ASSERT_GE(chosen[i], Puma560::kLow[i] - 1e-8);
      ASSERT_LE(chosen[i], Puma560::kHigh[i] + 1e-8);
      if (p % 10 < 2) continue;
      ASSERT_LE(std::abs(chosen[i] - near[i]), off + 1e-6) << p;  // q itself would be a solution
    }
  }
  EXPECT_LT(farthest, kAgreed);
}

TEST_F(InverseAgainstKdl, OutOfReachThereIsNoClosedForm) {
  KdlArm kdl(puma());
  for (std::size_t p = 0; p < 20000; ++p) {
    const Joints q = random.joints(p);
    Frame wanted = forward(kdl, q);
    const Vec3 wrist = wanted.origin - Puma560::d6 * wanted.z;
    const double reach = Puma560::a2 + std::hypot(Puma560::a3, Puma560::d4) + Puma560::d3;
    wanted.origin = ((reach + within(1e-3, 2)) / length(wrist)) * wrist + Puma560::d6 * wanted.z;
    Joints stands{9, 9, 9, 9, 9, 9};
    ASSERT_FALSE(Puma560::nearest(wanted, six(q), std::span<double, 6>(stands.data(), 6)));
    ASSERT_EQ(stands[0], 9);
  }
}

/// Result of a search of up to `calls` cycles.
struct Searched {
  bool is_solved = false;
  double residual = 0;
  Joints q{};
};

Searched search(const DhChain& chain, const Frame& wanted, const Joints& begin, const JointLimits& limits, int calls) {
  const SerialArm arm(chain);
  PoseSearch search;
  search.limits = limits;
  Searched found{false, 0, begin};
  for (std::size_t i = 0; i < chain.ndof; ++i) found.q[i] = limits.cut(i, begin[i]);
  for (int call = 0; call < calls && !found.is_solved; ++call) {
    found.is_solved = search.solve(arm, wanted, {found.q.data(), chain.ndof}, kAgreed);
  }
  found.residual = search.residual();
  return found;
}

// The generic search reaches the pose within the limits, or reports the remaining error.
TEST_F(InverseAgainstKdl, TheSearchIsThereOrSaysHowFarItIsNot) {
  std::size_t solved = 0, searched = 0, refused = 0, far = 0;
  double farthest = 0, dishonest = 0;
  for (std::size_t c = 0; c < 60; ++c) {
    const DhChain chain = c % 4 == 0 ? puma() : random.chain(6 + c % 5, c % 2 == 0);
    KdlArm kdl(chain);
    for (std::size_t p = 0; p < 50; ++p) {
      const Joints goal = random.joints(p);
      Frame wanted = forward(kdl, goal);
      const bool is_far = p % 5 == 4;
      if (is_far) wanted.origin = wanted.origin + Vec3{20, 0, 0};
      Joints begin = goal;
      JointLimits limits;
      for (std::size_t i = 0; i < chain.ndof; ++i) {
        begin[i] += within(-0.3, 0.3);
        if (p % 2 == 1) limits.low[i] = goal[i] - 0.5, limits.high[i] = goal[i] + (p % 4 == 1 ? 0.5 : 0);
      }
      const Searched found = search(chain, wanted, begin, limits, is_far ? 1 : 10);
      const double missing = difference(forward(kdl, found.q), wanted);
      if (found.is_solved) farthest = std::max(farthest, missing);
      if (found.residual < 0.1) {  // the residual counts a turn as its angle; one axis moves at least 0.8 of that
        dishonest = std::max({dishonest, missing - found.residual, 0.8 * found.residual - missing});
      }
      for (std::size_t i = 0; i < chain.ndof; ++i) {
        ASSERT_GE(found.q[i], limits.low[i]);
        ASSERT_LE(found.q[i], limits.high[i]);
      }
      if (is_far) ++far, refused += !found.is_solved;
      else ++searched, solved += found.is_solved;
    }
  }
  EXPECT_LT(farthest, kAgreed);
  EXPECT_LT(dishonest, 1e-9);
  EXPECT_EQ(refused, far);
  EXPECT_GT(static_cast<double>(solved) / static_cast<double>(searched), 0.8);
  RecordProperty("solved_per_mille", static_cast<int>(1000 * solved / searched));
}

}  // namespace
}  // namespace chimera::library
