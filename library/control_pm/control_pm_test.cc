// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "chimera/task/rig.h"

namespace chimera::control_pm_test {
namespace {

constexpr Nanoseconds kPeriod = milliseconds(20);

struct ControlPmTest : ::testing::Test {
  /// Engine force less brake force.
  double cycle(double vr, double vz) {
    rig.set("vr", vr);
    rig.set("vz", vz);
    EXPECT_TRUE(rig.cycle(kPeriod));
    return engine() - brakes();
  }
  double engine() { return rig.get<double>("fde"); }
  double brakes() { return rig.get<double>("fdw"); }
  Rig rig{"control_pm"};
};

TEST_F(ControlPmTest, IsTheControlWithItsForceSplit) {
  Rig control("control");
  ASSERT_TRUE(rig.init());
  ASSERT_TRUE(control.init());
  for (int i = 0; i < 400; ++i) {
    const double vz = 20 + 2 * std::sin(0.05 * i);
    control.set("vr", 20.0);
    control.set("vz", vz);
    ASSERT_TRUE(control.cycle(kPeriod));
    const double fd = control.get<double>("fd");
    ASSERT_EQ(cycle(20, vz), fd) << i;
    ASSERT_EQ(engine(), std::max(0.0, fd));
    ASSERT_EQ(brakes(), std::max(0.0, -fd));
    ASSERT_EQ(rig.get<double>("fd"), fd);
  }
}

TEST_F(ControlPmTest, OnStartsAtTheForceOfTheEngineOrTheBrakes) {
  rig.set("ki", 0.0);
  rig.set("fde", 1000.0);
  rig.set("fdw", 0.0);
  ASSERT_TRUE(rig.init());
  ASSERT_TRUE(rig.on());
  EXPECT_EQ(rig.get<double>("fd"), 1000);
  EXPECT_NEAR(cycle(20, 19.5), 1000, 1e-9);
  rig.set("fde", 0.0);
  rig.set("fdw", 800.0);
  ASSERT_TRUE(rig.on());
  EXPECT_NEAR(cycle(20, 20.5), -800, 1e-9);
  EXPECT_EQ(engine(), 0);
}

TEST_F(ControlPmTest, OnDoesNotGoOnFromAnOldForce) {
  rig.set("ki", 0.0);
  rig.set("fde", 1000.0);
  rig.inherit("fde", milliseconds(41), kPeriod);
  ASSERT_TRUE(rig.init());
  ASSERT_TRUE(rig.on());
  EXPECT_EQ(engine(), 0);
  EXPECT_NEAR(cycle(20, 19.5), 0.5 * 2500, 1e-9);
}

TEST_F(ControlPmTest, HoldsItsForcesUnderTheFlagAndRefusesNonFiniteInputs) {
  ASSERT_TRUE(rig.init());
  const double force = cycle(20, 19.9);
  rig.illegal(true);
  EXPECT_EQ(cycle(20, std::nan("")), force);
  rig.illegal(false);
  EXPECT_EQ(rig.cycle(kPeriod).text, "vr or vz is not finite");
  EXPECT_EQ(engine(), force);
}

TEST_F(ControlPmTest, WantsNothingWhileItIsSwitchedOff) {
  ASSERT_TRUE(rig.init());
  cycle(20, 19.9);
  EXPECT_EQ(cycle(0, 19.9), 0);
  EXPECT_EQ(cycle(20, 20), 0);
}

TEST_F(ControlPmTest, RefusesConstantsOutsideTheirRange) {
  rig.set("drive_max", 20001.0);
  EXPECT_EQ(rig.init().text, "drive_max and brake_max are 0 to 20000 N");
  rig.set("drive_max", 2000.0);
  rig.set("ki", -1.0);
  EXPECT_EQ(rig.reinit().text, "kp and ki are 0 to 1e6");
}

}  // namespace
}  // namespace chimera::control_pm_test
