// SPDX-License-Identifier: Apache-2.0
// Properties of both simulated cars.
#include <gtest/gtest.h>

#include <cmath>
#include <string>

#include "library/car/testing/car_rig.h"

namespace chimera::library {
namespace {

struct AnyCar : ::testing::TestWithParam<const char*> {
  CarRig rig{GetParam()};
};

TEST_P(AnyCar, ShowsWhereItStandsFromOnAlready) {
  rig.set("start_speed", 20.0);
  rig.resource("road", "0:0.02");
  ASSERT_TRUE(rig.init());
  ASSERT_TRUE(rig.on());
  EXPECT_DOUBLE_EQ(rig.get<double>("speed"), 72);
  EXPECT_EQ(rig.get<double>("xw"), 0);
  EXPECT_DOUBLE_EQ(rig.get<double>("grade"), 0.02);
}

TEST_P(AnyCar, RollsAsItsWheelsTurnAndSeesTheGradeWhereItIs) {
  rig.set("start_speed", 20.0);
  rig.resource("road", "0:0 200:0.1");
  ASSERT_TRUE(rig.init());
  ASSERT_TRUE(rig.drive(1));
  const double metres = rig.get<double>("xw") * 0.3;
  EXPECT_NEAR(metres, 20, 0.2);
  EXPECT_NEAR(rig.get<double>("grade"), 0.1 * metres / 200, 1e-12);
}

TEST_P(AnyCar, FeelsTheGradeOnEitherSide) {
  for (double grade : {0.1, -0.1}) {
    rig.resource("road", grade > 0 ? "0:0.1" : "0:-0.1");
    ASSERT_TRUE(rig.init());
    ASSERT_TRUE(rig.drive(1));
    const double slope = std::atan(grade), rubbed = std::copysign(0.01 * std::cos(slope), grade);
    EXPECT_NEAR(rig.speed(), -9.81 * (std::sin(slope) - rubbed), 1e-3);
  }
}

TEST_P(AnyCar, ReinitTakesAnotherLoadWhereItIsAndAtItsSpeed) {
  rig.set("start_speed", 20.0);
  ASSERT_TRUE(rig.init());
  ASSERT_TRUE(rig.drive(1));
  const double angle = rig.get<double>("xw"), before = rig.speed();
  rig.set("mass", 2000.0);
  rig.set("wheel_radius", 0.5);
  ASSERT_TRUE(rig.reinit());
  ASSERT_TRUE(rig.drive(0.01));
  EXPECT_NEAR(rig.speed(), before, 0.01);
  EXPECT_NEAR(rig.get<double>("xw"), angle + before * 0.01 / 0.5, 1e-3);
}

TEST_P(AnyCar, StartsAtTheStateOfTheTaskThatItReplaces) {
  rig.set("start_speed", 5.0);
  rig.resource("road", "0:0 200:0.1");
  ASSERT_TRUE(rig.init());
  rig.set("xw", 100 / 0.3), rig.set("speed", 72.0);
  for (const char* port : {"xw", "speed"}) rig.inherit(port, milliseconds(10));
  ASSERT_TRUE(rig.on());
  EXPECT_DOUBLE_EQ(rig.get<double>("xw"), 100 / 0.3);
  EXPECT_DOUBLE_EQ(rig.get<double>("speed"), 72);
  EXPECT_DOUBLE_EQ(rig.get<double>("grade"), 0.05);
  ASSERT_TRUE(rig.drive(0.01));
  EXPECT_NEAR(rig.get<double>("xw"), (100 + 0.2) / 0.3, 1e-2);
}

TEST_P(AnyCar, OffAndOnGoOnFromThePresentState) {
  rig.set("start_speed", 20.0);
  ASSERT_TRUE(rig.init());
  ASSERT_TRUE(rig.drive(1));
  const double angle = rig.get<double>("xw"), before = rig.speed();
  ASSERT_TRUE(rig.off());
  ASSERT_TRUE(rig.on());
  EXPECT_EQ(rig.get<double>("xw"), angle);
  EXPECT_EQ(rig.speed(), before);
}

TEST_P(AnyCar, RefusesConstantsOutsideTheirRange) {
  const double nan = std::nan("");
  expect_refused(GetParam(), {{"mass", 499, "mass is 500 to 40000 kg"},
                              {"mass", 40001, "mass is 500 to 40000 kg"},
                              {"mass", nan, "mass is 500 to 40000 kg"},
                              {"wheel_radius", 0.09, "wheel_radius is 0.1 to 1 m"},
                              {"wheel_radius", 1.1, "wheel_radius is 0.1 to 1 m"},
                              {"wheel_radius", nan, "wheel_radius is 0.1 to 1 m"},
                              {"start_speed", -1, "start_speed is 0 to 60 m/s"},
                              {"start_speed", 61, "start_speed is 0 to 60 m/s"},
                              {"start_speed", nan, "start_speed is 0 to 60 m/s"}});
}

TEST_P(AnyCar, RefusesARoadThatIsNoScriptOrTooSteep) {
  rig.resource("road", "");
  EXPECT_EQ(rig.init().text, "the script is empty: write at:value at:value ...");
  for (const char* road : {"0:0.31", "0:-0.31"}) {
    rig.resource("road", road);
    EXPECT_EQ(rig.init().text, "a grade of the road is outside -0.3 to 0.3");
  }
}

INSTANTIATE_TEST_SUITE_P(Of, AnyCar, ::testing::Values("car", "electric_car"),
                         [](const auto& one) { return std::string(one.param); });

}  // namespace
}  // namespace chimera::library
