// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include "library/signals/testing/signal_rig.h"

namespace chimera {
namespace {

struct RateLimitTest : ::testing::Test {
  SignalRig rig{"rate_limit"};
  void start(double x) {
    rig.set("rise", 2.0);
    rig.set("fall", 4.0);
    rig.set("x", x);
    ASSERT_TRUE(rig.init());
    ASSERT_TRUE(rig.on());
  }
};

TEST_F(RateLimitTest, MakesARampOfAStepEitherWayAndArrivesExactly) {
  start(0);
  EXPECT_EQ(rig.get<double>("y"), 0);
  for (int i = 1; i <= 100; ++i) EXPECT_NEAR(rig.step(0.201), 2e-3 * i, 1e-12);
  EXPECT_EQ(rig.step(0.201), 0.201);
  EXPECT_NEAR(rig.step(-1), 0.197, 1e-12);
}

TEST_F(RateLimitTest, TakesTheTimeThatWentByWhenReleasesWereDropped) {
  start(0);
  EXPECT_NEAR(rig.step(5, milliseconds(10)), 0.02, 1e-12);
}

TEST_F(RateLimitTest, StartsAtItsLastOutput) {
  start(1);
  ASSERT_TRUE(rig.off());
  rig.set("x", 9.0);
  ASSERT_TRUE(rig.on());
  EXPECT_EQ(rig.get<double>("y"), 1);
  EXPECT_NEAR(rig.step(9), 1.002, 1e-12);
}

TEST_F(RateLimitTest, RefusesRatesOfNothingAndNaN) {
  for (double rate : {0.0, -1.0, std::nan("")}) {
    rig.set("rise", 1.0);
    rig.set("fall", rate);
    EXPECT_EQ(rig.init().text, "rise and fall must be above 0");
  }
  start(1);
  rig.set("x", std::nan(""));
  EXPECT_EQ(rig.cycle().text, "x is not a finite number");
  EXPECT_TRUE(rig.error());
  EXPECT_NEAR(rig.step(0), 0.996, 1e-12);
}

TEST_F(RateLimitTest, TakesTheFirstValueThatComes) {
  rig.set("rise", 2.0);
  rig.set("fall", 4.0);
  ASSERT_TRUE(rig.init());
  ASSERT_TRUE(rig.on());
  EXPECT_EQ(rig.cycle().status, CHIMERA_ABORTED);
  EXPECT_EQ(rig.step(3), 3);
}

}  // namespace
}  // namespace chimera
