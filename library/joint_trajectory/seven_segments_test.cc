// SPDX-License-Identifier: Apache-2.0
#include "library/joint_trajectory/seven_segments.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>

namespace chimera::library {
namespace {

constexpr double kNone = std::numeric_limits<double>::infinity();

// Biagiotti and Melchiorri 2008, examples 3.9 and 3.10: q 0 to 10, a_max 10, j_max 30. With v_max 5 both limits are
// reached; with v_max 10 the velocity limit is not.
TEST(SevenSegments, HasTheTimesOfThePublishedExamples) {
  const SevenSegments both(0, 10, {5, 10, 30});
  EXPECT_NEAR(both.least_duration(), 2 * (1.0 / 3 + 0.5) + 10.0 / 5 - (1.0 / 3 + 0.5), 1e-12);
  const SevenSegments no_cruise(0, 10, {10, 10, 30});
  const double tj = 1.0 / 3, ta = tj / 2 + std::sqrt(tj * tj / 4 + 1);
  EXPECT_NEAR(no_cruise.least_duration(), 2 * ta, 1e-12);
  EXPECT_NEAR(no_cruise.at(ta).velocity, 10 * (ta - tj), 1e-9);
}

// Without a cruise sqrt(d / a) up and down; with a cruise d / v + v / a.
TEST(SevenSegments, WithoutALimitOfJerkIsTheTrapezoid) {
  EXPECT_DOUBLE_EQ(SevenSegments(0, 4, {100, 1, kNone}).least_duration(), 4);
  const SevenSegments cruise(0, 4, {1, 2, kNone});
  EXPECT_DOUBLE_EQ(cruise.least_duration(), 4.5);
  EXPECT_DOUBLE_EQ(cruise.at(0.25).velocity, 0.5);
  EXPECT_DOUBLE_EQ(cruise.at(2).velocity, 1);
  EXPECT_DOUBLE_EQ(cruise.at(2.25).position, 2);
  EXPECT_DOUBLE_EQ(cruise.at(4.25).acceleration, -2);
}

struct Excess {
  double velocity = 0, acceleration = 0, jerk = 0, seam = 0;
};

// Largest ratio of each derivative to its limit; the jerk comes from differences of the acceleration. Also the largest
// deviation of velocity and acceleration from the differences of position and velocity.
Excess watch(const SevenSegments& motion, const MotionLimits& limits, int samples) {
  Excess excess;
  const double h = motion.duration() / samples;
  Motion last = motion.at(0);
  for (int i = 1; i <= samples; ++i) {
    const Motion now = motion.at(i * h);
    excess.velocity = std::max(excess.velocity, std::abs(now.velocity) / limits.velocity);
    excess.acceleration = std::max(excess.acceleration, std::abs(now.acceleration) / limits.acceleration);
    excess.jerk = std::max(excess.jerk, std::abs(now.acceleration - last.acceleration) / h / limits.jerk);
    const double seam = now.position - last.position - h * (now.velocity + last.velocity) / 2;
    excess.seam = std::max(excess.seam, std::abs(seam));
    last = now;
  }
  return excess;
}

TEST(SevenSegments, KeepsWithinEveryLimitAtEverySampleAndEndsExactly) {
  std::mt19937_64 random(20260101);
  std::uniform_real_distribution<double> place(-3, 3), power(-2, 2), longer(1, 4);
  for (int n = 0; n < 2000; ++n) {
    const double from = place(random), to = n % 10 == 0 ? from + 1e-6 * place(random) : place(random);
    const MotionLimits limits{std::pow(10, power(random)), std::pow(10, power(random)),
                              n % 4 == 0 ? kNone : std::pow(10, power(random))};
    SevenSegments motion(from, to, limits);
    if (n % 3 == 0) motion.stretch(motion.least_duration() * longer(random));
    constexpr double kRounding = 1 + 1e-6;
    const Excess most = watch(motion, limits, 400);
    ASSERT_LE(most.velocity, kRounding) << "seed 20260101, motion " << n;
    ASSERT_LE(most.acceleration, kRounding) << "seed 20260101, motion " << n;
    ASSERT_LE(most.jerk, 1 + 1e-4) << "seed 20260101, motion " << n;
    const double h = motion.duration() / 400;
    ASSERT_LE(most.seam, 0.51 * limits.acceleration * h * h + 1e-12) << "seed 20260101, motion " << n;
    ASSERT_EQ(motion.at(motion.duration()).position, to);
    ASSERT_EQ(motion.at(motion.duration()).velocity, 0);
    ASSERT_EQ(motion.at(-1).position, from);
  }
}

// Every motion is at one limit all the time, so that no motion can be faster: velocity while it cruises, otherwise
// acceleration or jerk.
TEST(SevenSegments, IsAlwaysAtSomeLimit) {
  std::mt19937_64 random(7);
  std::uniform_real_distribution<double> place(-3, 3), power(-1, 1);
  for (int n = 0; n < 200; ++n) {
    const MotionLimits limits{std::pow(10, power(random)), std::pow(10, power(random)), std::pow(10, power(random))};
    const SevenSegments motion(place(random), place(random), limits);
    const double h = motion.duration() / 1000;
    int below = 0;
    for (int i = 1; i < 1000; ++i) {
      const Motion before = motion.at((i - 0.5) * h), now = motion.at((i + 0.5) * h);
      const double jerk = std::abs(now.acceleration - before.acceleration) / h;
      const bool at_limit = std::abs(now.velocity) > 0.9999 * limits.velocity ||
                            std::abs(now.acceleration) > 0.9999 * limits.acceleration || jerk > 0.9999 * limits.jerk;
      below += at_limit ? 0 : 1;
    }
    ASSERT_LE(below, 7) << "seed 7, motion " << n;  // samples at the ends of segments
  }
}

TEST(SevenSegments, AStretchedMotionHasTheGivenDurationAndThePathOfTheOriginal) {
  SevenSegments motion(1, 3, {1, 2, 5}), same = motion;
  same.stretch(2 * motion.least_duration());
  EXPECT_DOUBLE_EQ(same.duration(), 2 * motion.duration());
  for (double t = 0; t < motion.duration(); t += 0.1) {
    EXPECT_NEAR(same.at(2 * t).position, motion.at(t).position, 1e-12);
    EXPECT_NEAR(same.at(2 * t).velocity, motion.at(t).velocity / 2, 1e-12);
  }
  same.stretch(0.1);  // shorter than the least time: no effect
  EXPECT_DOUBLE_EQ(same.duration(), 2 * motion.duration());
}

TEST(SevenSegments, WithoutAWayStands) {
  const SevenSegments motion(2, 2, {1, 1, 1});
  EXPECT_EQ(motion.duration(), 0);
  EXPECT_EQ(motion.at(0).position, 2);
  EXPECT_EQ(motion.at(5).velocity, 0);
}

}  // namespace
}  // namespace chimera::library
