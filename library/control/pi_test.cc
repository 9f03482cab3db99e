// SPDX-License-Identifier: Apache-2.0
#include "library/control/pi.h"

#include <gtest/gtest.h>

#include <cmath>

#include "library/car/car_model.h"

namespace chimera::library {
namespace {

TEST(Pi, AddsItsTermsAndStaysWithinItsLimits) {
  Pi pi;
  EXPECT_DOUBLE_EQ(pi.step(10, 2, 3, 0.5, -100, 100), 30 + 3);
  EXPECT_EQ(pi.step(10, 2, 30, 0.5, -100, 100), 100);
  EXPECT_DOUBLE_EQ(pi.integral(), 3);
  EXPECT_EQ(pi.step(10, 2, -30, 0.5, -100, 100), -100);
  EXPECT_DOUBLE_EQ(pi.integral(), 3);
}

struct Drive {
  CarModel car;
  Pi pi;
  CarEngine engine;
  double opening = 0;

  // One period of the cruise control with the default gains of the component `control`.
  void period(double wanted, double grade) {
    const double force = pi.step(2500, 600, wanted - car.speed(), 0.02, -4000, 2280);
    for (int i = 0; i < 4; ++i) {
      opening += (std::fmax(0, force) / 2280 - opening) * 5e-3 / (0.2 + 5e-3);
      car.step(engine.force(opening, car.speed()), std::fmax(0, -force), grade, 5e-3);
    }
  }
};

TEST(Pi, Holds100KilometresAnHourOnAHillWithin1) {
  Drive drive;
  drive.car.place(100 / 3.6);
  for (double t = 0; t < 30; t += 0.02) drive.period(100 / 3.6, 0);
  double worst = 0;
  for (double t = 0; t < 60; t += 0.02) {
    const double grade = std::fmin(0.04, 0.04 * t / 3.6);  // the hill begins on 100 m of road
    drive.period(100 / 3.6, grade);
    worst = std::fmax(worst, std::abs(drive.car.speed() * 3.6 - 100));
  }
  EXPECT_LT(worst, 1.0);
  EXPECT_NEAR(drive.car.speed() * 3.6, 100, 0.05);
}

TEST(Pi, RecoversSoonAfterAFastDriver) {
  Drive drive;
  drive.car.place(130 / 3.6);
  drive.pi.start(600);
  for (double t = 0; t < 60; t += 0.02) drive.pi.step(2500, 600, 100 / 3.6 - 130 / 3.6, 0.02, -4000, 2280);
  for (double t = 0; t < 12; t += 0.02) drive.period(100 / 3.6, 0);
  EXPECT_NEAR(drive.car.speed() * 3.6, 100, 1.0);
}

}  // namespace
}  // namespace chimera::library
