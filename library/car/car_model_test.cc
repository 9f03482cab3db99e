// SPDX-License-Identifier: Apache-2.0
#include "library/car/car_model.h"

#include <gtest/gtest.h>

namespace chimera::library {
namespace {

void roll(CarModel& car, double drive, double brake, double grade, double seconds) {
  for (int i = 0; i < static_cast<int>(seconds * 1000); ++i) car.step(drive, brake, grade, 1e-3);
}

TEST(CarModel, HoldsItsSpeedWhenTheForceBalancesAirRoadAndHill) {
  CarModel car;
  const double v = 100 / 3.6, slope = std::atan(0.04);
  car.place(v);
  const double air = 0.5 * 1.3 * 0.32 * 2.4 * v * v;
  roll(car, air + 1600 * 9.81 * (std::sin(slope) + 0.01 * std::cos(slope)), 0, 0.04, 20);
  EXPECT_NEAR(car.speed(), v, 1e-9);
  EXPECT_NEAR(car.distance(), 20 * v, 1e-6);
  EXPECT_NEAR(car.wheel_angle(), 20 * v / 0.3, 1e-5);
}

TEST(CarModel, BrakesStopItAndDoNotPushItBack) {
  CarModel car;
  car.place(20);
  roll(car, 0, 8000, 0, 10);
  EXPECT_EQ(car.speed(), 0);
  EXPECT_NEAR(car.distance(), 20 * 20 / (2 * (8000 / 1600.0 + 0.0981)), 1.0);
  roll(car, 0, 8000, 0.2, 5);
  EXPECT_EQ(car.speed(), 0);
}

TEST(CarModel, RollsBackOnAHillWithoutBrakes) {
  CarModel car;
  roll(car, 0, 0, 0.1, 2);
  EXPECT_NEAR(car.speed(), -2 * 9.81 * (std::sin(std::atan(0.1)) - 0.01 * std::cos(std::atan(0.1))), 0.01);
}

TEST(CarEngine, HasItsPeakAtThePrintedSpeed) {
  const CarEngine engine;
  EXPECT_DOUBLE_EQ(engine.force(1, 420.0 / 12), 12 * 190);
  EXPECT_LT(engine.force(1, 20), 12 * 190);
  EXPECT_DOUBLE_EQ(engine.force(0.5, 420.0 / 12), 0.5 * 12 * 190);
  EXPECT_DOUBLE_EQ(engine.force(7, 35), engine.force(1, 35));
  EXPECT_EQ(engine.force(-1, 35), 0);
  EXPECT_EQ(engine.force(1, 1000), 0);
}

}  // namespace
}  // namespace chimera::library
