// SPDX-License-Identifier: Apache-2.0
#include "library/joint_trajectory/quintic.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

namespace chimera::library {
namespace {

constexpr Quintic kPath{.from = -0.25, .to = 1.0, .duration = 2.0};

TEST(Quintic, RestsInBothEnds) {
  for (double t : {-1.0, 0.0}) {
    EXPECT_EQ(kPath.at(t).position, -0.25);
    EXPECT_EQ(kPath.at(t).velocity, 0);
    EXPECT_EQ(kPath.at(t).acceleration, 0);
  }
  for (double t : {2.0, 99.0}) {
    EXPECT_EQ(kPath.at(t).position, 1.0);
    EXPECT_EQ(kPath.at(t).velocity, 0);
    EXPECT_EQ(kPath.at(t).acceleration, 0);
  }
}

TEST(Quintic, LeavesAndArrivesWithoutAJumpOfAcceleration) {
  for (double t : {1e-7, 2.0 - 1e-7}) EXPECT_LT(std::abs(kPath.at(t).acceleration), 1e-5);
}

TEST(Quintic, PeaksInVelocityHalfwayAtThePrintedFigure) {
  EXPECT_DOUBLE_EQ(kPath.at(1.0).velocity, 1.875 * 1.25 / 2.0);
  EXPECT_DOUBLE_EQ(kPath.at(1.0).position, 0.375);
  double most = 0;
  for (int i = 0; i <= 2000; ++i) most = std::max(most, kPath.at(i * 1e-3).velocity);
  EXPECT_DOUBLE_EQ(most, 1.875 * 1.25 / 2.0);
}

TEST(Quintic, PeaksInAccelerationAtThePrintedFigure) {
  double most = 0;
  for (int i = 0; i <= 20000; ++i) most = std::max(most, kPath.at(i * 1e-4).acceleration);
  EXPECT_NEAR(most, 10 / std::sqrt(3.0) * 1.25 / 4.0, 1e-6);
}

TEST(Quintic, BeginsWithTheMotionItIsGivenAndEndsAtRest) {
  constexpr Quintic path{-0.25, 1.0, 2.0, 0.8, -3.0};
  EXPECT_NEAR(path.at(1e-9).position, -0.25, 1e-8);
  EXPECT_NEAR(path.at(1e-9).velocity, 0.8, 1e-7);
  EXPECT_NEAR(path.at(1e-9).acceleration, -3.0, 1e-7);
  EXPECT_EQ(path.at(0).velocity, 0.8);
  EXPECT_NEAR(path.at(2 - 1e-9).position, 1.0, 1e-9);
  EXPECT_NEAR(path.at(2 - 1e-9).velocity, 0, 1e-7);
  EXPECT_NEAR(path.at(2 - 1e-9).acceleration, 0, 1e-7);
  constexpr double h = 1e-5;
  for (double t = 0.05; t < 2; t += 0.1) {
    EXPECT_NEAR((path.at(t + h).position - path.at(t - h).position) / (2 * h), path.at(t).velocity, 1e-8);
    EXPECT_NEAR((path.at(t + h).velocity - path.at(t - h).velocity) / (2 * h), path.at(t).acceleration, 1e-8);
  }
}

TEST(Quintic, VelocityAndAccelerationAreTheDerivatives) {
  constexpr double h = 1e-5;
  for (double t = 0.05; t < 2; t += 0.1) {
    EXPECT_NEAR((kPath.at(t + h).position - kPath.at(t - h).position) / (2 * h), kPath.at(t).velocity, 1e-8);
    EXPECT_NEAR((kPath.at(t + h).velocity - kPath.at(t - h).velocity) / (2 * h), kPath.at(t).acceleration, 1e-8);
  }
}

}  // namespace
}  // namespace chimera::library
