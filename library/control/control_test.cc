// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "chimera/task/rig.h"

namespace chimera {
namespace {

constexpr Nanoseconds kPeriod = milliseconds(20);

struct ControlTest : ::testing::Test {
  double cycle(double vr, double vz) {
    rig.set("vr", vr);
    rig.set("vz", vz);
    EXPECT_TRUE(rig.cycle(kPeriod));
    return rig.get<double>("fd");
  }
  Rig rig{"control"};
};

TEST_F(ControlTest, AddsAProportionalAndAnIntegralForceOfBothSigns) {
  ASSERT_TRUE(rig.init());
  EXPECT_DOUBLE_EQ(cycle(20, 19.9), 2500 * (20 - 19.9) + 600 * (20 - 19.9) * 0.02);
  EXPECT_NEAR(cycle(20, 20.2), -2500 * 0.2 + 600 * 0.02 * (0.1 - 0.2), 1e-9);
}

TEST_F(ControlTest, StaysWithinItsLimitsAndDoesNotWindUpAtThem) {
  ASSERT_TRUE(rig.init());
  for (int i = 0; i < 500; ++i) ASSERT_EQ(cycle(30, 10), 2280);
  EXPECT_NEAR(cycle(30, 30), 0, 1e-9);
  for (int i = 0; i < 500; ++i) ASSERT_EQ(cycle(10, 30), -4000);
  EXPECT_NEAR(cycle(30, 30), 0, 1e-9);
}

TEST_F(ControlTest, OnStartsAtTheLastForce) {
  rig.set("ki", 0.0);
  rig.set("fd", 1000.0);
  ASSERT_TRUE(rig.init());
  ASSERT_TRUE(rig.on());
  EXPECT_NEAR(cycle(20, 19.5), 1000, 1e-9);
  EXPECT_NEAR(cycle(20, 20), 1000 - 0.5 * 2500, 1e-9);
}

TEST_F(ControlTest, OnDoesNotGoOnFromAnOldForce) {
  rig.set("ki", 0.0);
  rig.set("fd", 1000.0);
  rig.inherit("fd", milliseconds(41), kPeriod);
  ASSERT_TRUE(rig.init());
  ASSERT_TRUE(rig.on());
  EXPECT_EQ(rig.get<double>("fd"), 0);
  EXPECT_NEAR(cycle(20, 19.5), 0.5 * 2500, 1e-9);
  rig.set("fd", 1000.0);
  rig.inherit("fd", milliseconds(40), kPeriod);
  ASSERT_TRUE(rig.on());
  EXPECT_NEAR(cycle(20, 19.5), 1000, 1e-9);
}

TEST_F(ControlTest, OnTakesOverNoMoreThanItsLimits) {
  rig.set("ki", 0.0);
  rig.set("fd", 1.0);
  ASSERT_TRUE(rig.init());
  ASSERT_TRUE(rig.on());
  EXPECT_EQ(cycle(30, 5), 2280);  // an integral of -62500 N would brake here for minutes
  EXPECT_EQ(cycle(30, 30), -4000);
}

TEST_F(ControlTest, OnStartsAfreshWhenNoForceStands) {
  ASSERT_TRUE(rig.init());
  cycle(20, 19.9);
  rig.set("fd", 0.0);
  ASSERT_TRUE(rig.on());
  EXPECT_NEAR(cycle(20, 19.5), 0.5 * (2500 + 600 * 0.02), 1e-9);
}

TEST_F(ControlTest, WantsNothingAndForgetsItsIntegralWhileItIsSwitchedOff) {
  ASSERT_TRUE(rig.init());
  cycle(20, 19.9);
  EXPECT_EQ(cycle(0, 19.9), 0);
  EXPECT_EQ(cycle(20, 20), 0);
}

TEST_F(ControlTest, HoldsItsForceAndDoesNotIntegrateWhileTheConfigurationIsIllegal) {
  ASSERT_TRUE(rig.init());
  const double force = cycle(20, 19.9);
  rig.illegal(true);
  for (int i = 0; i < 50; ++i) ASSERT_EQ(cycle(20, std::nan("")), force);
  rig.illegal(false);
  EXPECT_NEAR(cycle(20, 20), 600 * 0.1 * 0.02, 1e-9);
}

TEST_F(ControlTest, ReinitTakesNewGainsAndKeepsTheIntegral) {
  ASSERT_TRUE(rig.init());
  cycle(20, 19.9);
  rig.set("kp", 1000.0);
  ASSERT_TRUE(rig.reinit());
  EXPECT_NEAR(cycle(20, 19.9), 1000 * 0.1 + 2 * 600 * 0.1 * 0.02, 1e-9);
}

TEST_F(ControlTest, AnInputThatIsNotFiniteIsAFaultAndLeavesTheForce) {
  ASSERT_TRUE(rig.init());
  const double force = cycle(20, 19.9);
  rig.set("vz", std::nan(""));
  EXPECT_EQ(rig.cycle(kPeriod).text, "vr or vz is not finite");
  rig.set("vz", 20.0);
  rig.set("vr", std::numeric_limits<double>::infinity());
  EXPECT_EQ(rig.cycle(kPeriod).text, "vr or vz is not finite");
  EXPECT_EQ(rig.get<double>("fd"), force);
}

TEST_F(ControlTest, RefusesConstantsOutsideTheirRange) {
  for (const char* limit : {"drive_max", "brake_max"})
    for (double wrong : {-1.0, 20001.0, std::nan("")}) {
      Rig other("control");
      other.set(limit, wrong);
      EXPECT_EQ(other.init().text, "drive_max and brake_max are 0 to 20000 N") << limit << ' ' << wrong;
      EXPECT_FALSE(other.reinit());
    }
  for (const char* gain : {"kp", "ki"})
    for (double wrong : {-1.0, 1.1e6, std::nan("")}) {
      Rig other("control");
      other.set(gain, wrong);
      EXPECT_EQ(other.init().text, "kp and ki are 0 to 1e6") << gain << ' ' << wrong;
    }
}

}  // namespace
}  // namespace chimera
