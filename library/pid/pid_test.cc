// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <cmath>
#include <functional>

#include "chimera/task/rig.h"

namespace chimera {
namespace {

struct PidTest : ::testing::Test {
  Rig rig{"pid"};

  void give(double kp, double ki, double kd, double limit = 1e6) {
    rig.extent("n", 1);
    rig.set("kp", kp), rig.set("ki", ki), rig.set("kd", kd);
    rig.set("low", -limit), rig.set("high", limit);
    rig.set("reference", 0.0), rig.set("measured", 0.0);
  }
  void start() {
    const RigAnswer made = rig.init();
    ASSERT_TRUE(made) << made.text;
    ASSERT_TRUE(rig.on());
  }
  double step(double reference, double measured, Nanoseconds dt = milliseconds(1)) {
    rig.set("reference", reference), rig.set("measured", measured);
    return rig.cycle(dt) ? rig.get<double>("output") : std::nan("");
  }
  /// Controls `plant` (input, time step; returns its output) for `seconds` after a step of the reference to 1.
  void follow(double dt, double seconds, const std::function<double(double, double)>& plant,
              const std::function<double(double)>& closed, double tolerance) {
    double y = 0;
    step(0, 0, Nanoseconds{std::llround(dt * 1e9)});
    for (int k = 0; k * dt < seconds; ++k) {
      ASSERT_NEAR(y, closed(k * dt), tolerance) << k * dt;
      y = plant(step(1, y, Nanoseconds{std::llround(dt * 1e9)}), dt);
    }
  }
};

TEST_F(PidTest, AddsItsThreeTerms) {
  give(2, 30, 0.5);
  start();
  EXPECT_EQ(step(0, 0), 0);
  EXPECT_DOUBLE_EQ(step(1, 0.25), 2 * 0.75 + 30 * 0.75 * 1e-3 - 0.5 * 0.25 / 1e-3);
  EXPECT_DOUBLE_EQ(step(1, 0.25), 2 * 0.75 + 2 * 30 * 0.75 * 1e-3);  // constant measured value: no rate
}

// 1/s under PI, both poles at -a (kp = 2 a, ki = a2). The weight of the reference moves the zero of the loop: y(t) = 1
// - exp(-a t) (1 - a t) at b = 1, and 1 - exp(-a t) (1 + a t) at b = 0, which does not overshoot.
TEST_F(PidTest, HasTheStepResponseOfTheClosedFormForEachWeightOfTheReference) {
  constexpr double a = 10;
  for (const double b : {1.0, 0.5, 0.0}) {
    give(2 * a, a * a, 0);
    rig.set("reference_weight", b);
    start();
    double y = 0;
    follow(
        1e-4, 1.0, [&](double u, double dt) { return y += u * dt; },
        [&](double t) { return 1 - std::exp(-a * t) * (1 + (1 - 2 * b) * a * t); }, 2e-3);
    ASSERT_TRUE(rig.off());
    rig.set("output", 0.0);
  }
}

// 1/s2 with all three poles at -a (kp = 3 a2, ki = a3, kd = 3 a); the plant is exact between steps. The numerator of
// the loop is c 3a s2 + b 3a2 s + a3, and y(t) = 1 - exp(-at) (1 + p at + q a2t2).
TEST_F(PidTest, HasTheStepResponseOfTheClosedFormForEachWeightOfTheDerivative) {
  constexpr double a = 20;
  constexpr struct { double b, c, p, q; } kWeights[] = {{0, 0, 1, 0.5}, {1, 0, 1, -1}, {1, 1, -2, 0.5}};
  for (const auto& weight : kWeights) {
    give(3 * a * a, a * a * a, 3 * a, 1e9);
    rig.set("reference_weight", weight.b), rig.set("derivative_weight", weight.c);
    start();
    double q = 0, qd = 0;
    const auto plant = [&](double u, double dt) {
      q += qd * dt + u * dt * dt / 2, qd += u * dt;
      return q;
    };
    follow(
        4e-5, 0.6, plant,
        [&](double t) {
          const double at = a * t;
          return 1 - std::exp(-at) * (1 + weight.p * at + weight.q * at * at);
        },
        2e-3);
    ASSERT_TRUE(rig.off());
    rig.set("output", 0.0);
  }
}

// A motor at constant speed needs ff * reference, and ff_rate * its slope while it accelerates. The error is then 0,
// and so are the gains here.
TEST_F(PidTest, FeedsTheReferenceAndItsRateForward) {
  give(0, 0, 0);
  rig.set("ff", 0.5), rig.set("ff_rate", 0.25);
  start();
  EXPECT_EQ(step(2, 0), 0);  // bumpless: the first output is the last one
  EXPECT_DOUBLE_EQ(step(3, 0), 0.5 * (3 - 2) + 0.25 * 1000);
  EXPECT_DOUBLE_EQ(step(3, 0), 0.5 * (3 - 2));
}

TEST_F(PidTest, FiltersBothRatesWithOneTimeConstant) {
  constexpr double kFilter = 9e-3;  // a tenth of the rest decays in every millisecond
  give(0, 0, 2);
  rig.set("filter_time", kFilter), rig.set("ff_rate", 5.0);
  start();
  step(0, 0);
  double rest = 1;
  for (int k = 1; k <= 40; ++k) {  // slopes of 1/s up and 1/s down
    rest *= 0.9;
    ASSERT_NEAR(step(k * 1e-3, -k * 1e-3), (2 + 5) * (1 - rest), 1e-12) << k;
  }
}

TEST_F(PidTest, IsCutAndDoesNotWindUp) {
  give(1, 100, 0);
  rig.set("low", -2.0), rig.set("high", 5.0);
  start();
  for (int k = 0; k < 10000; ++k) step(3, 0);
  EXPECT_EQ(rig.get<double>("output"), 5);
  EXPECT_LT(step(3, 3.5), 5);  // leaves its limit with the first error of the other sign
  for (int k = 0; k < 10000; ++k) step(-3, 0);
  EXPECT_EQ(rig.get<double>("output"), -2);
  EXPECT_GT(step(-3, -3.5), -2);
}

// The integral may use only the part of the limits that the feed-forward leaves.
TEST_F(PidTest, CountsTheFeedForwardWhenItJudgesTheLimit) {
  give(0, 100, 0);
  rig.set("high", 5.0), rig.set("ff", 10.0);
  start();
  step(0, 0);
  for (int k = 0; k < 1000; ++k) ASSERT_EQ(step(1, 0), 5);
  EXPECT_NEAR(step(0, 0), 0, 1e-12);
}

TEST_F(PidTest, TakesAnErrorWithinTheDeadbandForNone) {
  give(10, 0, 0);
  rig.set("deadband", 0.5);
  start();
  step(0, 0);
  EXPECT_EQ(step(0.5, 0), 0);
  EXPECT_EQ(step(0, 0.4), 0);
  EXPECT_DOUBLE_EQ(step(0.75, 0), 2.5);
  EXPECT_DOUBLE_EQ(step(-0.75, 0), -2.5);
}

TEST_F(PidTest, StartsAtItsLastOutput) {
  give(4, 1, 0.1);
  rig.set("ff", 2.0), rig.set("reference_weight", 0.3);
  rig.set("output", 7.0);
  start();
  EXPECT_NEAR(step(10, 8), 7 + 1 * 2 * 1e-3, 1e-12);
}

TEST_F(PidTest, StartsAtAFreshHandedOverOutputOnly) {
  give(4, 1, 0.1);
  rig.set("output", 7.0);
  rig.inherit("output", milliseconds(200), milliseconds(100));
  start();
  EXPECT_NEAR(step(10, 8), 7 + 1 * 2 * 1e-3, 1e-12);
  rig.set("output", 7.0);
  rig.inherit("output", milliseconds(201), milliseconds(100));
  ASSERT_TRUE(rig.on());
  EXPECT_EQ(rig.get<double>("output"), 0);
  EXPECT_NEAR(step(10, 8), 1 * 2 * 1e-3, 1e-12);
  rig.set("low", 1.0);
  rig.set("output", 7.0);
  ASSERT_TRUE(rig.on());
  EXPECT_EQ(rig.get<double>("output"), 1) << "within its limits";
}

TEST_F(PidTest, ADifferentKiMakesNoStep) {
  give(1, 50, 0);
  start();
  for (int k = 0; k < 100; ++k) step(1, 0.5);
  const double before = step(1, 1);
  rig.set("ki", 500.0);
  EXPECT_DOUBLE_EQ(step(1, 1), before);
}

TEST_F(PidTest, OffItHoldsOrGoesToZeroWithinTheLimits) {
  give(1, 0, 0);
  start();
  step(0, 0), step(3, 0);
  ASSERT_TRUE(rig.off());
  EXPECT_EQ(rig.get<double>("output"), 3);
  rig.set("holds_off", false);
  ASSERT_TRUE(rig.off());
  EXPECT_EQ(rig.get<double>("output"), 0);
  rig.set("low", 1.0);
  ASSERT_TRUE(rig.off());
  EXPECT_EQ(rig.get<double>("output"), 1);
}

TEST_F(PidTest, HoldsWhileTheConfigurationIsIllegalAndDoesNotIntegrate) {
  give(1, 100, 0);
  start();
  step(0, 0);
  rig.illegal(true);
  for (int k = 0; k < 1000; ++k) ASSERT_EQ(step(1, 0), 0);
  rig.illegal(false);
  EXPECT_NEAR(step(1, 0), 0.1, 1e-12);
}

TEST_F(PidTest, WaitsForInputsAndIsOverNaNWithTheNextGoodOne) {
  Rig fresh("pid");
  fresh.extent("n", 1);
  fresh.set("low", -1.0), fresh.set("high", 1.0);
  ASSERT_TRUE(fresh.init());
  ASSERT_TRUE(fresh.on());
  EXPECT_EQ(fresh.cycle().status, CHIMERA_ABORTED);
  give(1, 1, 1);
  start();
  const double before = step(1, 0.5);
  rig.set("measured", std::nan(""));
  EXPECT_EQ(rig.cycle().text, "measured is not a finite number");
  EXPECT_TRUE(rig.error());
  EXPECT_EQ(rig.get<double>("output"), before);
  EXPECT_NEAR(step(1, 0.5), before + 0.5e-3, 1e-9);
}

TEST_F(PidTest, GainsTooLargeForADoubleAreAFaultAndLeaveNothingBehind) {
  give(1e308, 1e308, 0, HUGE_VAL);
  start();
  step(0, 0);
  rig.set("reference", 1e10);
  EXPECT_EQ(rig.cycle().text, "the output is not finite: the gains or the inputs are too large");
  rig.set("kp", 1.0), rig.set("ki", 0.0);
  EXPECT_EQ(step(1, 0), 0);
  EXPECT_EQ(step(2, 0), 1);
}

TEST_F(PidTest, ControlsEachElementByItself) {
  rig.extent("n", 2);
  for (std::size_t i = 0; i < 2; ++i) {
    const auto number = static_cast<double>(i + 1);
    rig.set("kp", number, i), rig.set("ki", 0.0, i), rig.set("kd", 0.0, i);
    rig.set("low", -10 * number, i), rig.set("high", 10 * number, i);
    rig.set("reference", 0.0, i), rig.set("measured", 0.0, i);
  }
  start();
  ASSERT_TRUE(rig.cycle());
  rig.set("measured", -4.0, 0), rig.set("measured", -100.0, 1);
  ASSERT_TRUE(rig.cycle());
  EXPECT_EQ(rig.get<double>("output", 0), 4);
  EXPECT_EQ(rig.get<double>("output", 1), 20);
}

TEST_F(PidTest, RefusesConstantsThatMeanNothing) {
  give(1, 1, 1);
  const auto refusal = [&](const char* port, double bad, double good) {
    rig.set(port, bad);
    const std::string text = rig.init().text;
    rig.set(port, good);
    return text;
  };
  EXPECT_EQ(refusal("low", 2e6, -1), "low must be at most high");
  EXPECT_EQ(refusal("high", std::nan(""), 1), "low must be at most high");
  EXPECT_EQ(refusal("filter_time", -1, 0), "filter_time must be 0 to 86400 s");
  EXPECT_EQ(refusal("reference_weight", 1.5, 1), "reference_weight and derivative_weight must be 0 to 1");
  EXPECT_EQ(refusal("derivative_weight", -0.5, 0), "reference_weight and derivative_weight must be 0 to 1");
  EXPECT_EQ(refusal("deadband", -1, 0), "deadband must be 0 or more");
  EXPECT_EQ(refusal("ff", std::nan(""), 0), "ff and ff_rate must be finite");
  EXPECT_EQ(refusal("ff_rate", HUGE_VAL, 0), "ff and ff_rate must be finite");
  EXPECT_TRUE(rig.init());
}

}  // namespace
}  // namespace chimera
