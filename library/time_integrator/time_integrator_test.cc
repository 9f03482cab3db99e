// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <cmath>

#include "chimera/task/rig.h"

namespace chimera {
namespace {

struct TimeIntegratorTest : ::testing::Test {
  Rig rig{"time_integrator"};
  void start() {
    rig.extent("n", 2);
    rig.set("start", 1.0, 0);
    rig.set("start", -1.0, 1);
    rig.set("rate_of_change", 2.0, 0);
    rig.set("rate_of_change", 0.0, 1);
    ASSERT_TRUE(rig.init());
    ASSERT_TRUE(rig.on());
  }
};

TEST_F(TimeIntegratorTest, IsTheRectangleSumFromItsStart) {
  start();
  EXPECT_EQ(rig.get<double>("integral", 0), 1);
  for (int i = 0; i < 100; ++i) ASSERT_TRUE(rig.cycle(milliseconds(10)));
  EXPECT_NEAR(rig.get<double>("integral", 0), 3, 1e-12);
  EXPECT_EQ(rig.get<double>("integral", 1), -1);
}

TEST_F(TimeIntegratorTest, TakesAScalarAndAMatrixElementByElement) {
  Rig scalar("time_integrator");
  scalar.shape("n", 1, 1);
  scalar.set("start", 1.0);
  scalar.set("rate_of_change", 2.0);
  ASSERT_TRUE(scalar.init() && scalar.on() && scalar.cycle(milliseconds(500)));
  EXPECT_EQ(scalar.get<double>("integral"), 2);
  Rig matrix("time_integrator");
  matrix.shape("n", 8, 8);
  for (int i = 0; i < 64; ++i) {
    matrix.set("start", 1.0 * i, static_cast<std::size_t>(i));
    matrix.set("rate_of_change", -1.0 * i, static_cast<std::size_t>(i));
  }
  ASSERT_TRUE(matrix.init() && matrix.on() && matrix.cycle(milliseconds(500)));
  ASSERT_EQ(matrix.size("integral"), 64u);
  for (int i = 0; i < 64; ++i) EXPECT_EQ(matrix.get<double>("integral", static_cast<std::size_t>(i)), 0.5 * i);
}

TEST_F(TimeIntegratorTest, ARefusedStartLeavesTheIntegral) {
  start();
  rig.set("start", 7.0, 0);
  rig.set("start", std::nan(""), 1);
  EXPECT_EQ(rig.on().text, "start is not finite");
  EXPECT_EQ(rig.get<double>("integral", 0), 1);
}

TEST_F(TimeIntegratorTest, StartsAtTheHandedOverIntegralOrItsStart) {
  start();
  rig.set("integral", 5.0, 0);
  rig.inherit("integral", milliseconds(4), milliseconds(2));
  ASSERT_TRUE(rig.on());
  ASSERT_TRUE(rig.cycle(milliseconds(10)));
  EXPECT_DOUBLE_EQ(rig.get<double>("integral", 0), 5.02);
  rig.inherit("integral", milliseconds(40), milliseconds(2));
  ASSERT_TRUE(rig.on());
  EXPECT_EQ(rig.get<double>("integral", 0), 1) << "an old integral";
}

TEST_F(TimeIntegratorTest, StandsWhileTheConfigurationIsIllegal) {
  start();
  rig.illegal(true);
  ASSERT_TRUE(rig.cycle());
  EXPECT_EQ(rig.get<double>("integral", 0), 1);
  rig.illegal(false);
  rig.set("start", 3.0, 0);
  ASSERT_TRUE(rig.cycle(milliseconds(10)));
  EXPECT_EQ(rig.get<double>("integral", 0), 3.02) << "begins where the machine stands";
}

TEST_F(TimeIntegratorTest, AddsNothingThatIsNotFinite) {
  start();
  rig.set("rate_of_change", std::nan(""), 1);
  EXPECT_EQ(rig.cycle().text, "rate_of_change[1] is not a finite number");
  EXPECT_EQ(rig.get<double>("integral", 0), 1);
  EXPECT_TRUE(rig.error());
  rig.set("rate_of_change", 0.0, 1);
  ASSERT_TRUE(rig.cycle(milliseconds(10)));
  EXPECT_EQ(rig.get<double>("integral", 0), 1.02);
  rig.set("start", std::nan(""), 0);
  EXPECT_EQ(rig.on().text, "start is not finite");
}

}  // namespace
}  // namespace chimera
