// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <complex>
#include <numbers>

#include "chimera/base/math.h"
#include "library/signals/testing/signal_rig.h"

namespace chimera {
namespace {

struct LowpassTest : ::testing::Test {
  SignalRig rig{"lowpass"};
  void start(double cutoff, std::int32_t order, double x = 0) {
    rig.set("cutoff", cutoff);
    rig.set("order", order);
    rig.set("x", x);
    const RigAnswer made = rig.init();
    ASSERT_TRUE(made) << made.text;
    ASSERT_TRUE(rig.on());
  }
};

TEST_F(LowpassTest, HasTheGainOfTheClosedFormAtEveryFrequencyForEveryOrder) {
  for (std::int32_t order = 1; order <= 8; ++order) {
    start(50, order);
    for (double f : {1.0, 10.0, 25.0, 50.0, 75.0, 100.0, 200.0, 400.0}) {
      const double ratio = std::tan(math::kPi * f * 1e-3) / std::tan(math::kPi * 0.05);
      const double closed = 1 / std::sqrt(1 + std::pow(ratio, 2 * order));
      EXPECT_NEAR(rig.gain(f), closed, 1e-9) << "order " << order << " at " << f << " Hz";
    }
  }
}

// Oppenheim and Schafer 2010, example 7.3: |H| = 0.17783 at 0.3 pi, order 6, printed as
// 0.0007378 (1 + z^-1)^6 / ((1 - 1.2686 z^-1 + 0.7051 z^-2) (1 - 1.0106 z^-1 + 0.3583 z^-2)
// (1 - 0.9044 z^-1 + 0.2155 z^-2)).
TEST_F(LowpassTest, IsThePrintedExampleOfOrderSix) {
  const double analog = std::tan(0.15 * math::kPi) / std::pow(1 / (0.17783 * 0.17783) - 1, 1.0 / 12);
  start(std::atan(analog) / math::kPi * 1000, 6);
  constexpr double a[3][2] = {{-1.2686, 0.7051}, {-1.0106, 0.3583}, {-0.9044, 0.2155}};
  double w1[3] = {}, w2[3] = {};  // direct form II, one section each
  for (int k = 0; k < 80; ++k) {
    double v = k == 0 ? 0.0007378 : 0;
    for (int s = 0; s < 3; ++s) {
      const double w = v - a[s][0] * w1[s] - a[s][1] * w2[s];
      v = w + 2 * w1[s] + w2[s];
      w2[s] = w1[s], w1[s] = w;
    }
    ASSERT_NEAR(rig.step(k == 0 ? 1 : 0), v, 2e-4) << k;  // the book prints four digits; the peak is 0.15
  }
}

TEST_F(LowpassTest, StartsWithoutATransientAndEndsWhereTheStepWent) {
  start(20, 4, 3.5);
  EXPECT_EQ(rig.get<double>("y"), 3.5);
  for (int i = 0; i < 10; ++i) EXPECT_NEAR(rig.step(3.5), 3.5, 1e-12);
  double y = 0;
  for (int i = 0; i < 1000; ++i) y = rig.step(-1);
  EXPECT_NEAR(y, -1, 1e-9);
}

// In the steady state a ramp is delayed by sqrt(2)/(2 pi f) for any sequence of time steps.
TEST_F(LowpassTest, TakesLongerStepsWhenReleasesWereDropped) {
  start(5, 2);
  double t = 0, y = 0;
  for (int i = 0; i < 3000; ++i) {
    const int ms = i % 7 == 0 ? 4 : 1;
    t += ms * 1e-3;
    y = rig.step(t, milliseconds(ms));
  }
  const double g = std::tan(math::kPi * 5e-3) / math::kPi / 5e-3;  // prewarping changes the delay slightly
  EXPECT_NEAR(t - y, std::numbers::sqrt2 / (2 * math::kPi * 5) / g, 2e-4);
  for (int i = 0; i < 10; ++i) EXPECT_TRUE(std::isfinite(rig.step(t, milliseconds(5000))));  // far above half the rate
}

TEST_F(LowpassTest, RefusesWrongConstants) {
  for (double cutoff : {0.0, -1.0, std::nan("")}) {
    rig.set("cutoff", cutoff);
    rig.set("order", 2);
    EXPECT_EQ(rig.init().text, "cutoff must be above 0 Hz");
  }
  rig.set("cutoff", 10.0);
  for (std::int32_t order : {0, 9}) {
    rig.set("order", order);
    EXPECT_EQ(rig.init().text, "order must be 1 to 8");
  }
  start(500, 2);  // before the first cycle the rig has no period
  rig.step(0);
  EXPECT_EQ(rig.on().text, "cutoff must be below half the rate of the task");
}

TEST_F(LowpassTest, NaNDoesNotStayInItsStates) {
  start(50, 5, 2);
  ASSERT_NEAR(rig.step(2), 2, 1e-12);
  rig.set("x", std::nan(""));
  EXPECT_EQ(rig.cycle().text, "x is not a finite number");
  EXPECT_TRUE(rig.error());
  EXPECT_NEAR(rig.step(2), 2, 1e-12);
}

TEST(Lowpass, FiltersEachElementAlone) {
  SignalRig list("lowpass", 64), one("lowpass");
  for (Rig* rig : {static_cast<Rig*>(&list), static_cast<Rig*>(&one)}) rig->set("cutoff", 30.0), rig->set("order", 3);
  for (std::size_t i = 0; i < 64; ++i) list.set("x", 0.0, i);
  one.set("x", 0.0);
  for (SignalRig* rig : {&list, &one}) ASSERT_TRUE(rig->init() && rig->on());
  for (int k = 0; k < 50; ++k) {
    list.set("x", 1.0, 63);
    ASSERT_TRUE(list.cycle());
    EXPECT_EQ(list.get<double>("y", 63), one.step(1));
    EXPECT_EQ(list.get<double>("y", 62), 0);
  }
}

}  // namespace
}  // namespace chimera
