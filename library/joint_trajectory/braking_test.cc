// SPDX-License-Identifier: Apache-2.0
#include "library/joint_trajectory/braking.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>
#include <string>

namespace chimera::library {
namespace {

TEST(Braking, AtRestItStaysWhereItIs) {
  const Braking still({0.7, 0, 0}, {1, 2, 20});
  EXPECT_EQ(still.duration(), 0);
  EXPECT_EQ(still.rest(), 0.7);
  EXPECT_EQ(still.at(5).position, 0.7);
}

TEST(Braking, WithoutALimitOfJerkItIsTheParabola) {
  const Braking stop({1, -3, 0.5}, {1, 2, std::numeric_limits<double>::infinity()});
  EXPECT_DOUBLE_EQ(stop.duration(), 1.5);
  EXPECT_DOUBLE_EQ(stop.rest(), 1 - 3 * 1.5 / 2);
  EXPECT_DOUBLE_EQ(stop.at(0.5).velocity, -2);
  EXPECT_DOUBLE_EQ(stop.at(0.5).acceleration, 2);
}

// Closed form for v = 1, a = 0, j = 4, limit 1: 0.25 s to the deceleration, 0.75 s at it, 0.25 s back.
TEST(Braking, WithALimitOfJerkItHasThreePhases) {
  const Braking stop({0, 1, 0}, {1, 1, 4});
  EXPECT_DOUBLE_EQ(stop.duration(), 1.25);
  EXPECT_DOUBLE_EQ(stop.at(0.25).acceleration, -1);
  EXPECT_DOUBLE_EQ(stop.at(0.625).velocity, 0.5);
  EXPECT_DOUBLE_EQ(stop.rest(), 0.625);
}

// Any motion within the limits: position, velocity and acceleration have no jump, the limits hold, and the motion ends
// at rest.
TEST(Braking, KeepsItsLimitsAndDoesNotJump) {
  std::mt19937 dice(5);
  std::uniform_real_distribution<double> share(-1, 1), size(0.1, 10);
  for (int n = 0; n < 2000; ++n) {
    const MotionLimits most{size(dice), size(dice), size(dice)};
    const Motion from{share(dice), share(dice) * most.velocity, n % 4 == 0 ? 0 : share(dice) * most.acceleration};
    const Braking stop(from, most);
    SCOPED_TRACE("seed 5, motion " + std::to_string(n));
    constexpr int kSteps = 400;
    const double h = stop.duration() / kSteps;
    const double fastest = std::fabs(from.velocity) + from.acceleration * from.acceleration / most.jerk;
    Motion last = stop.at(0);
    ASSERT_NEAR(last.position, from.position, 1e-12);
    ASSERT_NEAR(last.velocity, from.velocity, 1e-12);
    ASSERT_NEAR(last.acceleration, from.acceleration, 1e-9);
    for (int i = 1; i <= kSteps; ++i) {
      const Motion now = stop.at(i == kSteps ? stop.duration() : i * h);
      ASSERT_LE(std::fabs(now.acceleration), most.acceleration * (1 + 1e-9));
      ASSERT_LE(std::fabs(now.velocity), fastest + 1e-9);
      ASSERT_LE(std::fabs(now.acceleration - last.acceleration), most.jerk * h + 1e-6 * most.acceleration);
      ASSERT_NEAR(now.velocity - last.velocity, (now.acceleration + last.acceleration) / 2 * h,
                  most.jerk * h * h + 1e-9);
      ASSERT_NEAR(now.position - last.position, (now.velocity + last.velocity) / 2 * h,
                  most.acceleration * h * h + 1e-9);
      last = now;
    }
    ASSERT_EQ(last.velocity, 0);
    ASSERT_EQ(last.acceleration, 0);
    ASSERT_EQ(last.position, stop.rest());
  }
}

TEST(Braking, AnAccelerationBeyondItsLimitOnlyFalls) {
  for (const double a : {5.0, -5.0}) {
    const Braking stop({0, 3, a}, {3, 1, 10});
    double last = std::fabs(a);
    for (double t = 0; t < stop.duration(); t += 1e-3) {
      const double now = std::fabs(stop.at(t).acceleration);
      ASSERT_LE(now, std::max(last, 1.0) + 1e-9) << a << " " << t;
      last = now;
    }
    EXPECT_NEAR(stop.at(stop.duration() - 1e-9).velocity, 0, 1e-6);
  }
}

}  // namespace
}  // namespace chimera::library
