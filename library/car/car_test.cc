// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <cmath>

#include "chimera/task/rig.h"

namespace chimera {
namespace {

struct CarTest : testing::Test {
  CarTest() {
    rig.resource("road", "0:0");
    rig.set("gas", 0.0);
    rig.set("fb", 0.0);
  }
  void drive(double seconds) {
    for (int i = 0; i < static_cast<int>(seconds * 100 + 0.5); ++i) ASSERT_TRUE(rig.cycle(milliseconds(10)));
  }
  double speed() { return rig.get<double>("speed") / 3.6; }
  Rig rig{"car"};
};

TEST_F(CarTest, ShowsWhereItStandsFromOnAlready) {
  rig.set("start_speed", 20.0);
  rig.resource("road", "0:0.02");
  ASSERT_TRUE(rig.init());
  ASSERT_TRUE(rig.on());
  EXPECT_DOUBLE_EQ(rig.get<double>("speed"), 72);
  EXPECT_EQ(rig.get<double>("xw"), 0);
  EXPECT_DOUBLE_EQ(rig.get<double>("grade"), 0.02);
}

TEST_F(CarTest, RollsAsItsWheelsTurnAndSeesTheGradeWhereItIs) {
  rig.set("start_speed", 20.0);
  rig.resource("road", "0:0 200:0.1");
  ASSERT_TRUE(rig.init());
  drive(1);
  const double metres = rig.get<double>("xw") * 0.3;
  EXPECT_NEAR(metres, 20, 0.2);
  EXPECT_NEAR(rig.get<double>("grade"), 0.1 * metres / 200, 1e-12);
}

TEST_F(CarTest, FeelsTheGradeOnEitherSide) {
  for (double grade : {0.1, -0.1}) {
    rig.resource("road", grade > 0 ? "0:0.1" : "0:-0.1");
    ASSERT_TRUE(rig.init());
    drive(1);
    const double slope = std::atan(grade), rubbed = std::copysign(0.01 * std::cos(slope), grade);
    EXPECT_NEAR(speed(), -9.81 * (std::sin(slope) - rubbed), 1e-3);
  }
}

TEST_F(CarTest, BrakesStopItAndHoldItOnAHill) {
  rig.set("start_speed", 20.0);
  rig.set("fb", 8000.0);
  rig.resource("road", "0:0.1");
  ASSERT_TRUE(rig.init());
  drive(10);
  EXPECT_EQ(speed(), 0);
  rig.set("fb", -8000.0);  // below 0 nothing pushes
  rig.resource("road", "0:0");
  ASSERT_TRUE(rig.reinit());
  drive(1);
  EXPECT_EQ(speed(), 0);
}

TEST_F(CarTest, TheEngineFollowsTheGasAfterItsLagAndIsCutAtOne) {
  rig.set("gas", 1.0);
  ASSERT_TRUE(rig.init());
  drive(0.02);
  const double early = speed() / 0.02;
  drive(2.98);
  const double fast = speed();
  EXPECT_LT(early, 0.2);
  EXPECT_NEAR(fast, (12 * 190 * 0.66 / 1600 - 0.0981) * 2.8, 0.2);  // 0.66: torque near standstill, T(w) / Tm
  rig.set("gas", 7.0);
  ASSERT_TRUE(rig.init());
  drive(3);
  EXPECT_DOUBLE_EQ(speed(), fast);
}

TEST_F(CarTest, RollsWhileTheConfigurationIsIllegal) {
  rig.set("start_speed", 20.0);
  ASSERT_TRUE(rig.init());
  rig.illegal(true);
  drive(2);
  const double free = speed();
  for (const char* input : {"gas", "fb"}) {
    rig.set("gas", 0.0);
    rig.set("fb", 0.0);
    rig.set(input, input[0] == 'g' ? 1.0 : 8000.0);
    ASSERT_TRUE(rig.init());
    drive(2);
    EXPECT_EQ(speed(), free) << input;
  }
}

TEST_F(CarTest, ReinitTakesAnotherLoadWhereItIsAndAtItsSpeed) {
  rig.set("start_speed", 20.0);
  ASSERT_TRUE(rig.init());
  drive(1);
  const double angle = rig.get<double>("xw"), before = speed();
  rig.set("mass", 2000.0);
  rig.set("wheel_radius", 0.5);
  ASSERT_TRUE(rig.reinit());
  drive(0.01);
  EXPECT_NEAR(speed(), before, 0.01);
  EXPECT_NEAR(rig.get<double>("xw"), angle + before * 0.01 / 0.5, 1e-3);
}

TEST_F(CarTest, OffAndOnGoOnFromThePresentState) {
  rig.set("start_speed", 20.0);
  ASSERT_TRUE(rig.init());
  drive(1);
  const double angle = rig.get<double>("xw"), before = speed();
  ASSERT_TRUE(rig.off());
  ASSERT_TRUE(rig.on());
  EXPECT_EQ(rig.get<double>("xw"), angle);
  EXPECT_EQ(speed(), before);
}

TEST_F(CarTest, AnInputThatIsNotFiniteIsAFaultAndMovesNothing) {
  rig.set("start_speed", 20.0);
  ASSERT_TRUE(rig.init());
  drive(1);
  const double before = speed();
  rig.set("gas", std::nan(""));
  EXPECT_EQ(rig.cycle().text, "gas or fb is not finite");
  rig.set("gas", 0.0);
  rig.set("fb", std::nan(""));
  EXPECT_EQ(rig.cycle().text, "gas or fb is not finite");
  rig.set("fb", 0.0);
  EXPECT_EQ(speed(), before);
}

TEST_F(CarTest, RefusesConstantsOutsideTheirRange) {
  struct Wrong {
    const char* name;
    double value;
    const char* text;
  };
  const double nan = std::nan("");
  for (const Wrong& wrong : {Wrong{"mass", 499, "mass is 500 to 40000 kg"},
                             Wrong{"mass", 40001, "mass is 500 to 40000 kg"},
                             Wrong{"mass", nan, "mass is 500 to 40000 kg"},
                             Wrong{"wheel_radius", 0.09, "wheel_radius is 0.1 to 1 m"},
                             Wrong{"wheel_radius", 1.1, "wheel_radius is 0.1 to 1 m"},
                             Wrong{"wheel_radius", nan, "wheel_radius is 0.1 to 1 m"},
                             Wrong{"start_speed", -1, "start_speed is 0 to 60 m/s"},
                             Wrong{"start_speed", 61, "start_speed is 0 to 60 m/s"},
                             Wrong{"start_speed", nan, "start_speed is 0 to 60 m/s"}}) {
    Rig other("car");
    other.resource("road", "0:0");
    other.set(wrong.name, wrong.value);
    EXPECT_EQ(other.init().text, wrong.text) << wrong.value;
  }
}

TEST_F(CarTest, RefusesARoadThatIsNoScriptOrTooSteep) {
  rig.resource("road", "");
  EXPECT_EQ(rig.init().text, "the script is empty: write at:value at:value ...");
  for (const char* road : {"0:0.31", "0:-0.31"}) {
    rig.resource("road", road);
    EXPECT_EQ(rig.init().text, "a grade of the road is outside -0.3 to 0.3");
  }
}

}  // namespace
}  // namespace chimera
