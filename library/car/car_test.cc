// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <cmath>

#include "library/car/testing/car_rig.h"

namespace chimera::library {
namespace {

struct CarTest : ::testing::Test {
  CarRig rig{"car"};
};

TEST_F(CarTest, BrakesStopItAndHoldItOnAHill) {
  rig.set("start_speed", 20.0);
  rig.set("fb", 8000.0);
  rig.resource("road", "0:0.1");
  ASSERT_TRUE(rig.init());
  ASSERT_TRUE(rig.drive(10));
  EXPECT_EQ(rig.speed(), 0);
  rig.set("fb", -8000.0);  // a negative brake force does not push
  rig.resource("road", "0:0");
  ASSERT_TRUE(rig.reinit());
  ASSERT_TRUE(rig.drive(1));
  EXPECT_EQ(rig.speed(), 0);
}

TEST_F(CarTest, TheEngineFollowsTheGasAfterItsLagAndIsCutAtOne) {
  rig.set("gas", 1.0);
  ASSERT_TRUE(rig.init());
  ASSERT_TRUE(rig.drive(0.02));
  const double early = rig.speed() / 0.02;
  ASSERT_TRUE(rig.drive(2.98));
  const double fast = rig.speed();
  EXPECT_LT(early, 0.2);
  EXPECT_NEAR(fast, (12 * 190 * 0.66 / 1600 - 0.0981) * 2.8, 0.2);  // 0.66: torque near standstill, T(w) / Tm
  rig.set("gas", 7.0);
  ASSERT_TRUE(rig.init());
  ASSERT_TRUE(rig.drive(3));
  EXPECT_DOUBLE_EQ(rig.speed(), fast);
}

TEST_F(CarTest, RollsWhileTheConfigurationIsIllegal) {
  rig.set("start_speed", 20.0);
  ASSERT_TRUE(rig.init());
  EXPECT_FALSE(rig.get<bool>("coasts"));
  rig.illegal(true);
  ASSERT_TRUE(rig.drive(2));
  EXPECT_TRUE(rig.get<bool>("coasts"));
  const double free = rig.speed();
  for (const char* input : {"gas", "fb"}) {
    rig.set("gas", 0.0);
    rig.set("fb", 0.0);
    rig.set(input, input[0] == 'g' ? 1.0 : 8000.0);
    ASSERT_TRUE(rig.init());
    ASSERT_TRUE(rig.drive(2));
    EXPECT_EQ(rig.speed(), free) << input;
  }
}

TEST_F(CarTest, AnInputThatIsNotFiniteIsAFaultAndMovesNothing) {
  rig.set("start_speed", 20.0);
  ASSERT_TRUE(rig.init());
  ASSERT_TRUE(rig.drive(1));
  const double before = rig.speed();
  rig.set("gas", std::nan(""));
  EXPECT_EQ(rig.cycle().text, "gas or fb is not finite");
  rig.set("gas", 0.0);
  rig.set("fb", std::nan(""));
  EXPECT_EQ(rig.cycle().text, "gas or fb is not finite");
  rig.set("fb", 0.0);
  EXPECT_EQ(rig.speed(), before);
}

}  // namespace
}  // namespace chimera::library
