// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <complex>
#include <numbers>

#include "chimera/base/math.h"
#include "library/signals/testing/signal_rig.h"

namespace chimera {
namespace {

struct NotchTest : ::testing::Test {
  SignalRig rig{"notch"};
  void start(double center, double width, double x = 0) {
    rig.set("center", center);
    rig.set("width", width);
    rig.set("x", x);
    ASSERT_TRUE(rig.init());
    ASSERT_TRUE(rig.on());
  }
};

TEST_F(NotchTest, HasTheGainOfTheClosedFormAtEveryFrequency) {
  start(50, 10);
  const double g = std::tan(math::kPi * 0.05), k = std::tan(math::kPi * 0.01) * (1 + g * g) / g;
  for (double f : {1.0, 20.0, 40.0, 45.0, 49.0, 50.0, 51.0, 60.0, 100.0, 250.0, 450.0}) {
    const std::complex<double> s(0, std::tan(math::kPi * f * 1e-3) / g);
    EXPECT_NEAR(rig.gain(f), std::abs((s * s + 1.0) / (s * s + k * s + 1.0)), 1e-9) << f << " Hz";
  }
}

TEST_F(NotchTest, IsExactlyAsWideAsItSays) {
  start(200, 60);  // near half the rate, where the transform distorts most
  // cos(2 pi f1) and cos(2 pi f2) of the band edges, whose frequencies differ by the width; tan tan = g^2.
  const double g = std::tan(math::kPi * 0.2), t = std::tan(math::kPi * 0.06);
  const double low = (-t * (1 + g * g) + std::sqrt(t * t * (1 + g * g) * (1 + g * g) + 4 * g * g)) / 2;
  const double f1 = std::atan(low) / math::kPi * 1000;
  EXPECT_NEAR(rig.gain(200), 0, 1e-9);
  EXPECT_NEAR(rig.gain(std::round(f1 * 4) / 4), std::numbers::sqrt2 / 2, 5e-3);
  EXPECT_NEAR(rig.gain(std::round((f1 + 60) * 4) / 4), std::numbers::sqrt2 / 2, 5e-3);
}

TEST_F(NotchTest, LetsAConstantThroughFromTheFirstCycle) {
  start(50, 5, 3.25);
  EXPECT_EQ(rig.get<double>("y"), 3.25);
  for (int i = 0; i < 20; ++i) EXPECT_NEAR(rig.step(3.25), 3.25, 1e-12);
}

TEST_F(NotchTest, RefusesWrongConstantsAndNaNDoesNotStay) {
  rig.set("center", 0.0);
  rig.set("width", 5.0);
  EXPECT_EQ(rig.init().text, "center and width must be at least 1e-6 Hz");
  rig.set("center", 5e-324);
  EXPECT_EQ(rig.init().text, "center and width must be at least 1e-6 Hz");
  rig.set("center", std::nan(""));
  EXPECT_EQ(rig.init().text, "center and width must be at least 1e-6 Hz");
  start(500, 5);
  rig.step(0);
  EXPECT_EQ(rig.on().text, "center and width must be below half the rate of the task");
  start(50, 5, 1);
  rig.step(1);
  rig.set("x", std::nan(""));
  EXPECT_EQ(rig.cycle().text, "x is not a finite number");
  EXPECT_TRUE(rig.error());
  EXPECT_NEAR(rig.step(1), 1, 1e-12);
}

}  // namespace
}  // namespace chimera
