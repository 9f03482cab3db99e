// SPDX-License-Identifier: Apache-2.0
#include "library/signals/tpt.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

namespace chimera::library {
namespace {

TEST(Prewarped, IsTheTangentAndEndsBelowHalfTheRate) {
  EXPECT_NEAR(prewarped(250, 1e-3), 1, 1e-15);
  EXPECT_EQ(prewarped(1e6, 1e-3), prewarped(490, 1e-3));
  EXPECT_TRUE(std::isfinite(prewarped(1e300, 1)));
}

TEST(FirstOrder, IsTheBilinearTransformOfOneOverSPlusOne) {
  const double g = prewarped(100, 1e-3);
  FirstOrder filter;
  double x1 = 0, y1 = 0;  // y[k] = (g (x[k] + x[k-1]) + (1 - g) y[k-1]) / (1 + g)
  for (int k = 0; k < 200; ++k) {
    const double x = std::sin(0.1 * k * k), y = (g * (x + x1) + (1 - g) * y1) / (1 + g);
    ASSERT_NEAR(filter.lowpass(x, g), y, 1e-13) << k;
    x1 = x, y1 = y;
  }
}

// scipy.signal.butter(2, 0.5), as in its manual and in tables of half-band filters.
TEST(SecondOrder, HasTheCoefficientsOfTheHalfBandButterworth) {
  const double g = prewarped(250, 1e-3), k = std::numbers::sqrt2;
  constexpr double b[] = {0.29289322, 0.58578644, 0.29289322}, a = 0.17157288;
  SecondOrder filter;
  double x1 = 0, x2 = 0, y2 = 0, y1 = 0;
  for (int i = 0; i < 100; ++i) {
    const double x = i == 0 ? 1 : 0, y = b[0] * x + b[1] * x1 + b[2] * x2 - a * y2;
    ASSERT_NEAR(filter.lowpass(x, g, k), y, 1e-8) << i;
    x2 = x1, x1 = x, y2 = y1, y1 = y;
  }
}

// Orfanidis 1996, example 11.3.1: 10 kHz, notch at 1.75 kHz, 500 Hz wide:
// 0.8633 (1 - 0.9080 z^-1 + z^-2) / (1 - 0.7838 z^-1 + 0.7265 z^-2).
TEST(SecondOrder, HasTheNotchOfOrfanidis) {
  const double dt = 1e-4, g = prewarped(1750, dt), k = prewarped(500, dt) * (1 + g * g) / g;
  SecondOrder filter;
  double x1 = 0, x2 = 0, y1 = 0, y2 = 0;
  for (int i = 0; i < 100; ++i) {
    const double x = i == 0 ? 1 : 0, y = 0.8633 * (x - 0.9080 * x1 + x2) + 0.7838 * y1 - 0.7265 * y2;
    ASSERT_NEAR(filter.notch(x, g, k), y, 2e-4) << i;
    x2 = x1, x1 = x, y2 = y1, y1 = y;
  }
}

TEST(SecondOrder, SettledItHasNoTransient) {
  SecondOrder filter;
  filter.settle(3.5);
  for (int i = 0; i < 10; ++i) EXPECT_DOUBLE_EQ(filter.lowpass(3.5, 0.3, 1.4), 3.5);
  filter.settle(-2);
  for (int i = 0; i < 10; ++i) EXPECT_DOUBLE_EQ(filter.notch(-2, 0.3, 0.1), -2);
}

}  // namespace
}  // namespace chimera::library
