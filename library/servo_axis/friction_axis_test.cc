// SPDX-License-Identifier: Apache-2.0
#include "library/servo_axis/friction_axis.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

namespace chimera::library {
namespace {

/// Integrates the equation by many midpoint steps, and looks for the sign of the motion in each.
struct SmallSteps {
  AxisBody body;
  double position = 0, velocity = 0;

  void step(double torque, double dt, int n) {
    for (double left = dt; left > 1e-12;) {
      const double h = std::min(dt / n, left);
      if (velocity == 0 && std::abs(torque) <= body.coulomb) return;
      const double sign = velocity != 0 ? std::copysign(1.0, velocity) : std::copysign(1.0, torque);
      const auto slope = [&](double w) { return (torque - body.viscous * w - sign * body.coulomb) / body.inertia; };
      const double middle = velocity + h / 2 * slope(velocity), next = velocity + h * slope(middle);
      if (velocity != 0 && next * sign <= 0) {
        const double stop = h * velocity / (velocity - next);
        position += velocity * stop / 2;
        velocity = 0;
        left -= stop;
        continue;
      }
      position += h * middle;
      velocity = next;
      left -= h;
    }
  }
};

TEST(FrictionAxis, AgreesWithANumericalIntegration) {
  constexpr unsigned kSeed = 5;
  std::mt19937 random(kSeed);
  const auto between = [&random](double low, double high) {
    return std::uniform_real_distribution<double>(low, high)(random);
  };
  int stops = 0, turns = 0;
  for (int trial = 0; trial < 200; ++trial) {
    AxisBody body{std::exp(between(-3, 1)), trial % 3 == 0 ? 0 : std::exp(between(-6, 3)),
                  trial % 4 == 0 ? 0 : between(0, 2)};
    FrictionAxis axis;
    axis.refit(body);
    SmallSteps oracle{body, between(-1, 1), between(-5, 5)};
    axis.place(oracle.position, oracle.velocity);
    for (int cycle = 0; cycle < 5; ++cycle) {
      const double torque = between(-4, 4), dt = between(1e-3, 0.2), before = axis.velocity();
      axis.step(torque, dt);
      oracle.step(torque, dt, 20'000);
      ASSERT_NEAR(axis.position(), oracle.position, 2e-5) << "trial " << trial << ", seed " << kSeed;
      ASSERT_NEAR(axis.velocity(), oracle.velocity, 1e-4) << "trial " << trial << ", seed " << kSeed;
      stops += axis.velocity() == 0 && before != 0;
      turns += axis.velocity() * before < 0;
    }
  }
  EXPECT_GT(stops, 20);
  EXPECT_GT(turns, 20);
}

TEST(FrictionAxis, OneStepEqualsManyUnderTheSameTorque) {
  for (double viscous : {0.0, 1e-9, 0.3, 50.0}) {
    FrictionAxis one, many;
    one.refit({0.2, viscous, 0.1}), many.refit({0.2, viscous, 0.1});
    one.place(1, -3), many.place(1, -3);
    one.step(2, 1);
    for (int i = 0; i < 1000; ++i) many.step(2, 1e-3);
    EXPECT_NEAR(one.position(), many.position(), 1e-11) << viscous;
    EXPECT_NEAR(one.velocity(), many.velocity(), 1e-11) << viscous;
  }
}

TEST(FrictionAxis, WithoutFrictionItFollowsTheParabola) {
  FrictionAxis axis;
  axis.refit({2, 0, 0});
  axis.place(0, 1);
  axis.step(4, 0.5);
  EXPECT_DOUBLE_EQ(axis.velocity(), 2);
  EXPECT_DOUBLE_EQ(axis.position(), 0.75);
}

TEST(FrictionAxis, CoulombFrictionHoldsAnAxisAtRest) {
  FrictionAxis axis;
  axis.refit({1, 0.1, 2});
  axis.place(0.5, 0);
  axis.step(2, 1), axis.step(-2, 1);
  EXPECT_EQ(axis.position(), 0.5);
  axis.step(2.1, 1);
  EXPECT_GT(axis.position(), 0.5);
  axis.step(-2, 100);
  EXPECT_EQ(axis.velocity(), 0) << "it stops, and stays";
}

TEST(FrictionAxis, StrongViscousFrictionEndsAtTheSteadyVelocity) {
  FrictionAxis axis;
  axis.refit({1e-9, 1e6, 0});
  axis.place(0, 5);
  axis.step(3, 1);
  EXPECT_DOUBLE_EQ(axis.velocity(), 3e-6);
  axis.step(0, 1);
  EXPECT_EQ(axis.velocity(), 0);
  EXPECT_TRUE(std::isfinite(axis.position()));
}

}  // namespace
}  // namespace chimera::library
