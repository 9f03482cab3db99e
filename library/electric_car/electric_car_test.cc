// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <cmath>

#include "chimera/task/rig.h"

namespace chimera {
namespace {

struct ElectricCarTest : testing::Test {
  ElectricCarTest() {
    rig.resource("road", "0:0");
    rig.set("fm", 0.0);
  }
  void drive(double seconds) {
    for (int i = 0; i < static_cast<int>(seconds * 100 + 0.5); ++i) ASSERT_TRUE(rig.cycle(milliseconds(10)));
  }
  double speed() { return rig.get<double>("speed") / 3.6; }
  Rig rig{"electric_car"};
};

TEST_F(ElectricCarTest, ShowsWhereItStandsFromOnAlready) {
  rig.set("start_speed", 20.0);
  rig.resource("road", "0:0.02");
  ASSERT_TRUE(rig.init());
  ASSERT_TRUE(rig.on());
  EXPECT_DOUBLE_EQ(rig.get<double>("speed"), 72);
  EXPECT_EQ(rig.get<double>("xw"), 0);
  EXPECT_DOUBLE_EQ(rig.get<double>("grade"), 0.02);
}

TEST_F(ElectricCarTest, RollsAsItsWheelsTurnAndSeesTheGradeWhereItIs) {
  rig.set("start_speed", 20.0);
  rig.resource("road", "0:0 200:0.1");
  ASSERT_TRUE(rig.init());
  drive(1);
  const double metres = rig.get<double>("xw") * 0.3;
  EXPECT_NEAR(metres, 20, 0.2);
  EXPECT_NEAR(rig.get<double>("grade"), 0.1 * metres / 200, 1e-12);
}

TEST_F(ElectricCarTest, FeelsTheGradeOnEitherSide) {
  for (double grade : {0.1, -0.1}) {
    rig.resource("road", grade > 0 ? "0:0.1" : "0:-0.1");
    ASSERT_TRUE(rig.init());
    drive(1);
    const double slope = std::atan(grade), rubbed = std::copysign(0.01 * std::cos(slope), grade);
    EXPECT_NEAR(speed(), -9.81 * (std::sin(slope) - rubbed), 1e-3);
  }
}

TEST_F(ElectricCarTest, TheMotorDrivesAndBrakesUpToItsForce) {
  for (double force : {1e9, -1e9}) {
    rig.set("fm", force);
    rig.set("start_speed", force > 0 ? 0.0 : 10.0);
    ASSERT_TRUE(rig.init());
    const double before = force > 0 ? 0.0 : 10.0;
    drive(1);
    EXPECT_NEAR(speed() - before, std::copysign(5000 / 1600.0, force) - 0.0981, 0.03);
  }
}

TEST_F(ElectricCarTest, TheMotorGivesNoMoreThanItsPower) {
  rig.set("start_speed", 40.0);
  rig.set("fm", 5000.0);
  ASSERT_TRUE(rig.init());
  drive(0.1);
  const double air = 0.5 * 1.3 * 0.32 * 2.4 * 40 * 40;
  EXPECT_NEAR((speed() - 40) / 0.1, (80e3 / 40 - air) / 1600 - 0.0981, 0.01);
}

TEST_F(ElectricCarTest, RollsWhileTheConfigurationIsIllegal) {
  rig.set("start_speed", 20.0);
  ASSERT_TRUE(rig.init());
  drive(2);
  const double free = speed();
  rig.set("fm", -3000.0);
  rig.illegal(true);
  ASSERT_TRUE(rig.init());
  drive(2);
  EXPECT_EQ(speed(), free);
}

TEST_F(ElectricCarTest, ReinitTakesAnotherLoadWhereItIsAndAtItsSpeed) {
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

TEST_F(ElectricCarTest, OffAndOnGoOnFromThePresentState) {
  rig.set("start_speed", 20.0);
  ASSERT_TRUE(rig.init());
  drive(1);
  const double angle = rig.get<double>("xw"), before = speed();
  ASSERT_TRUE(rig.off());
  ASSERT_TRUE(rig.on());
  EXPECT_EQ(rig.get<double>("xw"), angle);
  EXPECT_EQ(speed(), before);
}

TEST_F(ElectricCarTest, AnInputThatIsNotFiniteIsAFaultAndMovesNothing) {
  rig.set("start_speed", 20.0);
  ASSERT_TRUE(rig.init());
  drive(1);
  const double before = speed();
  rig.set("fm", std::nan(""));
  EXPECT_EQ(rig.cycle().text, "fm is not finite");
  rig.set("fm", 0.0);
  EXPECT_EQ(speed(), before);
}

TEST_F(ElectricCarTest, RefusesConstantsOutsideTheirRange) {
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
                             Wrong{"start_speed", nan, "start_speed is 0 to 60 m/s"},
                             Wrong{"force_max", -1, "force_max is 0 to 50000 N"},
                             Wrong{"force_max", 50001, "force_max is 0 to 50000 N"},
                             Wrong{"force_max", nan, "force_max is 0 to 50000 N"},
                             Wrong{"power_max", -1, "power_max is 0 to 1e6 W"},
                             Wrong{"power_max", 1.1e6, "power_max is 0 to 1e6 W"},
                             Wrong{"power_max", nan, "power_max is 0 to 1e6 W"}}) {
    Rig other("electric_car");
    other.resource("road", "0:0");
    other.set(wrong.name, wrong.value);
    EXPECT_EQ(other.init().text, wrong.text) << wrong.value;
  }
}

TEST_F(ElectricCarTest, RefusesARoadThatIsNoScriptOrTooSteep) {
  rig.resource("road", "");
  EXPECT_EQ(rig.init().text, "the script is empty: write at:value at:value ...");
  for (const char* road : {"0:0.31", "0:-0.31"}) {
    rig.resource("road", road);
    EXPECT_EQ(rig.init().text, "a grade of the road is outside -0.3 to 0.3");
  }
}

}  // namespace
}  // namespace chimera
