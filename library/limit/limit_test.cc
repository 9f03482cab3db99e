// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <limits>

#include "library/signals/testing/signal_rig.h"

namespace chimera {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

TEST(Limit, CutsEachElementAtItsOwnLimits) {
  SignalRig rig("limit", 3);
  for (std::size_t i = 0; i < 3; ++i) {
    rig.set("low", -1.0 - static_cast<double>(i), i);
    rig.set("high", 1.0, i);
    rig.set("x", -2.5, i);
  }
  ASSERT_TRUE(rig.init());
  ASSERT_TRUE(rig.on());
  EXPECT_EQ(rig.get<double>("y", 0), -1);  // computed by on
  rig.set("x", 7.0, 2);
  ASSERT_TRUE(rig.cycle());
  EXPECT_EQ(rig.get<double>("y", 0), -1);
  EXPECT_EQ(rig.get<double>("y", 1), -2);
  EXPECT_EQ(rig.get<double>("y", 2), 1);
}

TEST(Limit, ANumberWithinTheLimitsIsUnchangedToTheBit) {
  SignalRig rig("limit");
  rig.set("low", -kInfinity);
  rig.set("high", 10.0);
  ASSERT_TRUE(rig.init());
  for (double x : {0.1, -1e300, 10.0, -0.0}) EXPECT_EQ(rig.step(x), x);
}

TEST(Limit, RefusesLimitsInTheWrongOrderAndNaN) {
  SignalRig rig("limit");
  rig.set("low", 1.0);
  rig.set("high", 0.5);
  EXPECT_EQ(rig.init().text, "low must be at most high");
  rig.set("high", std::nan(""));
  EXPECT_EQ(rig.init().text, "low must be at most high");
  rig.set("high", 1.0);
  EXPECT_TRUE(rig.init());
}

// Full test of the rule for inputs of signal components (library/signals/input.h).
TEST(Limit, AnInputThatIsNotFiniteIsAFaultThatLeavesTheOutputAndIsRecovered) {
  SignalRig rig("limit", 2);
  for (std::size_t i = 0; i < 2; ++i) rig.set("low", -1.0, i), rig.set("high", 1.0, i), rig.set("x", 0.5, i);
  ASSERT_TRUE(rig.init());
  ASSERT_TRUE(rig.cycle());
  for (double bad : {std::nan(""), kInfinity, -kInfinity}) {
    rig.set("x", bad, 1);
    const RigAnswer answer = rig.cycle();
    EXPECT_EQ(answer.status, CHIMERA_FAULT);
    EXPECT_EQ(answer.text, "x[1] is not a finite number");
    EXPECT_EQ(rig.get<double>("y", 1), 0.5);
    EXPECT_TRUE(rig.error());
  }
  rig.set("x", 2.0, 1);
  ASSERT_TRUE(rig.cycle());
  EXPECT_EQ(rig.get<double>("y", 1), 1);
}

TEST(Limit, AbortsItsCycleUntilTheInputIsWritten) {
  SignalRig rig("limit");
  rig.set("low", -1.0);
  rig.set("high", 1.0);
  ASSERT_TRUE(rig.init());
  ASSERT_TRUE(rig.on());
  EXPECT_EQ(rig.cycle().status, CHIMERA_ABORTED);
  EXPECT_EQ(rig.step(0.5), 0.5);
}

}  // namespace
}  // namespace chimera
