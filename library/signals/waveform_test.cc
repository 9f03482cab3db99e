// SPDX-License-Identifier: Apache-2.0
#include "library/signals/waveform.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

namespace chimera::library {
namespace {

TEST(Waveform, HasTheValuesOfItsTable) {
  const double at[] = {0, 0.125, 0.25, 0.5, 0.625, 0.75};
  const double square[] = {1, 1, 1, -1, -1, -1}, triangle[] = {0, 0.5, 1, 0, -0.5, -1};
  const double saw[] = {0, 0.25, 0.5, -1, -0.75, -0.5};
  for (int i = 0; i < 6; ++i)
    for (double turn : {0.0, 3.0, -2.0}) {
      EXPECT_DOUBLE_EQ(waveform(Waveform::kSine, turn + at[i]), std::sin(2 * std::numbers::pi * at[i])) << i;
      EXPECT_DOUBLE_EQ(waveform(Waveform::kSquare, turn + at[i]), square[i]) << i;
      EXPECT_DOUBLE_EQ(waveform(Waveform::kTriangle, turn + at[i]), triangle[i]) << i;
      EXPECT_DOUBLE_EQ(waveform(Waveform::kSawtooth, turn + at[i]), saw[i]) << i;
      EXPECT_EQ(waveform(Waveform::kStep, turn + at[i]), 1);
    }
}

TEST(Waveform, IsFoundByItsNameOnly) {
  Waveform found = Waveform::kSine;
  EXPECT_TRUE(find_waveform("noise", found));
  EXPECT_EQ(found, Waveform::kNoise);
  EXPECT_FALSE(find_waveform("sin", found));
  EXPECT_FALSE(find_waveform("", found));
}

TEST(ChirpTurns, HaveTheFrequencyThatGrowsEvenlyAndBeginAgain) {
  constexpr double h = 1e-6;
  for (double t : {0.5, 1.0, 1.9}) {
    const double frequency = (chirp_turns(t + h, 1, 9, 2) - chirp_turns(t - h, 1, 9, 2)) / (2 * h);
    EXPECT_NEAR(frequency, 1 + 8 * t / 2, 1e-6);
    EXPECT_NEAR(chirp_turns(t + 4, 1, 9, 2), chirp_turns(t, 1, 9, 2), 1e-12);
  }
}

// Moments of a uniform distribution over 200,000 values within five standard errors, and no correlation of neighbours.
TEST(Noise, IsFlatWhiteAndRepeatable) {
  Noise noise(7), again(7), other(8);
  double sum = 0, squares = 0, fourth = 0, neighbours = 0, last = 0;
  constexpr int n = 200'000;
  int same = 0;
  for (int i = 0; i < n; ++i) {
    const double v = noise.next();
    ASSERT_EQ(v, again.next());
    same += v == other.next() ? 1 : 0;
    ASSERT_TRUE(v >= -1 && v < 1);
    sum += v, squares += v * v, fourth += v * v * v * v, neighbours += v * last;
    last = v;
  }
  EXPECT_NEAR(sum / n, 0, 5 * std::sqrt(1.0 / 3 / n));
  EXPECT_NEAR(squares / n, 1.0 / 3, 5 * std::sqrt((1.0 / 5 - 1.0 / 9) / n));
  EXPECT_NEAR(fourth / n, 1.0 / 5, 5 * std::sqrt((1.0 / 9 - 1.0 / 25) / n));
  EXPECT_NEAR(neighbours / n, 0, 5 * std::sqrt(1.0 / 9 / n));
  EXPECT_EQ(same, 0);
}

// The first three values of seed 1234567 in the published splitmix64.c.
TEST(Noise, IsThePublishedSequence) {
  Noise noise(1234567);
  for (const std::uint64_t bits : {6457827717110365317u, 3203168211198807973u, 9817491932198370423u})
    EXPECT_EQ(noise.next(), static_cast<double>(bits >> 11) * 0x1p-52 - 1);
}

}  // namespace
}  // namespace chimera::library
