// SPDX-License-Identifier: Apache-2.0
#include "library/pid_joint/pid.h"

#include <gtest/gtest.h>

namespace chimera::library {
namespace {

constexpr double kDt = 1e-3;
constexpr PidGains kGains{.kp = 100, .ki = 50, .kd = 10};

TEST(PidAxis, AddsItsThreeTerms) {
  PidAxis axis;
  EXPECT_DOUBLE_EQ(axis.step(kGains, 0.1, 0.2, kDt, 0, 1000), 100 * 0.1 + 10 * 0.2 + 50 * 0.1 * kDt);
  EXPECT_DOUBLE_EQ(axis.step(kGains, 0.1, 0.2, kDt, 0, 1000), 100 * 0.1 + 10 * 0.2 + 2 * 50 * 0.1 * kDt);
}

TEST(PidAxis, StartsWhereTheFormerOutputWas) {
  PidAxis axis;
  axis.start(kGains, 0.1, -0.3, 42);
  EXPECT_NEAR(axis.step(kGains, 0.1, -0.3, kDt, 5e-3, 1000), 42, 50 * 0.1 * kDt + 1e-12);
}

TEST(PidAxis, FiltersTheVelocityErrorToAThirdAfterOneTimeConstant) {
  PidAxis axis;
  double output = 0;
  for (int i = 0; i < 100; ++i) output = axis.step({.kp = 0, .ki = 0, .kd = 1}, 0, 1, kDt, 0.1, 1000);
  EXPECT_NEAR(output, 1 - 0.368, 0.005);
}

TEST(PidAxis, StaysWithinItsLimitEitherWay) {
  PidAxis axis;
  EXPECT_EQ(axis.step(kGains, 5, 0, kDt, 0, 20), 20);
  EXPECT_EQ(axis.step(kGains, -5, 0, kDt, 0, 20), -20);
}

TEST(PidAxis, DoesNotWindUpWhileItIsCut) {
  PidAxis axis;
  for (int i = 0; i < 10000; ++i) axis.step(kGains, 1, 0, kDt, 0, 20);
  EXPECT_EQ(axis.integral(), 0);
  EXPECT_LT(axis.step(kGains, -0.01, 0, kDt, 0, 20), 0);
}

TEST(PidAxis, IntegratesBackOutOfTheCut) {
  PidAxis axis;
  axis.start(kGains, 0, 0, 30);
  for (int i = 0; i < 1000; ++i) axis.step(kGains, -0.05, 0, kDt, 0, 20);
  EXPECT_NEAR(axis.integral(), 30 - 50 * 0.05, 1e-9);
}

TEST(PidAxis, RemovesASteadyErrorUnderAConstantLoad) {
  PidAxis axis;
  double position = 0, velocity = 0;
  for (int i = 0; i < 20000; ++i) {
    const double torque = axis.step(kGains, 1 - position, -velocity, kDt, 1e-3, 200);
    velocity += (torque - 30) / 1.0 * kDt;
    position += velocity * kDt;
  }
  EXPECT_NEAR(position, 1, 1e-4);
  EXPECT_NEAR(axis.integral(), 30, 1e-2);
}

}  // namespace
}  // namespace chimera::library
