// SPDX-License-Identifier: Apache-2.0
#include "library/pid/pid_axis.h"

#include <gtest/gtest.h>

#include <cmath>

namespace chimera::library {
namespace {

constexpr double kStep = 1e-3;
constexpr PidGains kGains{.kp = 100, .ki = 50, .kd = 10};

TEST(PidAxis, AddsItsThreeTerms) {
  PidAxis axis;
  EXPECT_DOUBLE_EQ(axis.step(kGains, 0.1, 0.2, kStep, 0, -1000, 1000), 100 * 0.1 + 10 * 0.2 + 50 * 0.1 * kStep);
  EXPECT_DOUBLE_EQ(axis.step(kGains, 0.1, 0.2, kStep, 0, -1000, 1000), 100 * 0.1 + 10 * 0.2 + 2 * 50 * 0.1 * kStep);
}

TEST(PidAxis, StartsWhereTheFormerOutputWas) {
  PidAxis axis;
  axis.start(kGains, 0.1, -0.3, 42);
  EXPECT_NEAR(axis.step(kGains, 0.1, -0.3, kStep, 5e-3, -1000, 1000), 42, 50 * 0.1 * kStep + 1e-12);
}

TEST(PidAxis, FiltersTheVelocityErrorToAThirdAfterOneTimeConstant) {
  PidAxis axis;
  double output = 0;
  for (int i = 0; i < 100; ++i) output = axis.step({.kp = 0, .ki = 0, .kd = 1}, 0, 1, kStep, 0.1, -1000, 1000);
  EXPECT_NEAR(output, 1 - 0.368, 0.005);
}

TEST(PidAxis, StaysWithinItsLimitEitherWay) {
  PidAxis axis;
  EXPECT_EQ(axis.step(kGains, 5, 0, kStep, 0, -20, 20), 20);
  EXPECT_EQ(axis.step(kGains, -5, 0, kStep, 0, -20, 20), -20);
}

TEST(PidAxis, DoesNotWindUpWhileItIsCut) {
  PidAxis axis;
  for (int i = 0; i < 10000; ++i) axis.step(kGains, 1, 0, kStep, 0, -20, 20);
  EXPECT_EQ(axis.integral(), 0);
  EXPECT_LT(axis.step(kGains, -0.01, 0, kStep, 0, -20, 20), 0);
}

TEST(PidAxis, IntegratesBackOutOfTheCut) {
  PidAxis axis;
  axis.start(kGains, 0, 0, 30);
  for (int i = 0; i < 1000; ++i) axis.step(kGains, -0.05, 0, kStep, 0, -20, 20);
  EXPECT_NEAR(axis.integral(), 30 - 50 * 0.05, 1e-9);
}

TEST(PidAxis, RemovesASteadyErrorUnderAConstantLoad) {
  PidAxis axis;
  double position = 0, velocity = 0;
  for (int i = 0; i < 20000; ++i) {
    const double torque = axis.step(kGains, 1 - position, -velocity, kStep, 1e-3, -200, 200);
    velocity += (torque - 30) / 1.0 * kStep;
    position += velocity * kStep;
  }
  EXPECT_NEAR(position, 1, 1e-4);
  EXPECT_NEAR(axis.integral(), 30, 1e-2);
}

// 1/s2 under PID with all three poles at -a (kp = 3 a2, ki = a3, kd = 3 a on the velocity). A step of the reference
// gives q(t) = 1 - exp(-a t) (1 + a t - a2 t2), a load of 1 N.m gives t2/2 exp(-a t). The plant is exact between steps.
TEST(PidAxis, HasTheStepResponsesOfTheClosedForm) {
  constexpr double a = 20, dt = 1e-5;
  constexpr PidGains gains{.kp = 3 * a * a, .ki = a * a * a, .kd = 3 * a};
  for (const bool is_load : {false, true}) {
    PidAxis axis;
    axis.start(gains, 0, 0, 0);
    double q = 0, qd = 0;
    for (int k = 0; k < 60'000; ++k) {
      const double t = k * dt, at = a * t;
      const double closed = is_load ? t * t / 2 * std::exp(-at) : 1 - std::exp(-at) * (1 + at - at * at);
      ASSERT_NEAR(q, closed, is_load ? 5e-7 : 5e-4) << t;  // peaks: 6.8e-4 and 1.3
      const double torque = axis.step(gains, (is_load ? 0 : 1) - q, -qd, dt, 0, -1e9, 1e9) + (is_load ? 1 : 0);
      q += qd * dt + torque * dt * dt / 2;
      qd += torque * dt;
    }
  }
}

}  // namespace
}  // namespace chimera::library
