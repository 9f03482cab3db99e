// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <cmath>

#include "library/car/testing/car_rig.h"

namespace chimera::library {
namespace {

struct ElectricCarTest : ::testing::Test {
  CarRig rig{"electric_car"};
};

TEST_F(ElectricCarTest, TheMotorDrivesAndBrakesUpToItsForce) {
  for (double force : {1e9, -1e9}) {
    rig.set("fm", force);
    rig.set("start_speed", force > 0 ? 0.0 : 10.0);
    ASSERT_TRUE(rig.init());
    const double before = force > 0 ? 0.0 : 10.0;
    ASSERT_TRUE(rig.drive(1));
    EXPECT_NEAR(rig.speed() - before, std::copysign(5000 / 1600.0, force) - 0.0981, 0.03);
  }
}

TEST_F(ElectricCarTest, TheMotorGivesNoMoreThanItsPower) {
  rig.set("start_speed", 40.0);
  rig.set("fm", 5000.0);
  ASSERT_TRUE(rig.init());
  ASSERT_TRUE(rig.drive(0.1));
  const double air = 0.5 * 1.3 * 0.32 * 2.4 * 40 * 40;
  EXPECT_NEAR((rig.speed() - 40) / 0.1, (80e3 / 40 - air) / 1600 - 0.0981, 0.01);
}

TEST_F(ElectricCarTest, RollsWhileTheConfigurationIsIllegal) {
  rig.set("start_speed", 20.0);
  ASSERT_TRUE(rig.init());
  ASSERT_TRUE(rig.drive(2));
  const double free = rig.speed();
  rig.set("fm", -3000.0);
  rig.illegal(true);
  ASSERT_TRUE(rig.init());
  ASSERT_TRUE(rig.drive(2));
  EXPECT_EQ(rig.speed(), free);
}

TEST_F(ElectricCarTest, AnInputThatIsNotFiniteIsAFaultAndMovesNothing) {
  rig.set("start_speed", 20.0);
  ASSERT_TRUE(rig.init());
  ASSERT_TRUE(rig.drive(1));
  const double before = rig.speed();
  rig.set("fm", std::nan(""));
  EXPECT_EQ(rig.cycle().text, "fm is not finite");
  rig.set("fm", 0.0);
  EXPECT_EQ(rig.speed(), before);
}

TEST_F(ElectricCarTest, RefusesConstantsOutsideTheirRange) {
  const double nan = std::nan("");
  expect_refused("electric_car", {{"force_max", -1, "force_max is 0 to 50000 N"},
                                  {"force_max", 50001, "force_max is 0 to 50000 N"},
                                  {"force_max", nan, "force_max is 0 to 50000 N"},
                                  {"power_max", -1, "power_max is 0 to 1e6 W"},
                                  {"power_max", 1.1e6, "power_max is 0 to 1e6 W"},
                                  {"power_max", nan, "power_max is 0 to 1e6 W"}});
}

}  // namespace
}  // namespace chimera::library
