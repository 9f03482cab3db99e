// SPDX-License-Identifier: Apache-2.0
// Ports and methods that all simulated cars share. A component adds the drive.
#pragma once

#include <cmath>

#include "chimera/task/component.h"
#include "library/car/car_model.h"
#include "library/script/script.h"

namespace chimera::library {

/// Base of a component that simulates a car. The component adds the in-vars of the driver and cycle().
struct RollingCar {
  Out<double> xw{"xw", "rad", doc = "Angle of a wheel since init, forward positive."};
  Out<double> speed{"speed", "km/h", doc = "True speed, for monitors only."};
  Out<double> grade{"grade", "1", doc = "Rise over run where the car is."};
  Out<bool> coasts{"coasts", initial = false, safe_state, doc = "The flag is up and the car rolls freely."};
  InConst<double> mass{"mass", "kg", initial = 1600.0, range(500, 40000), doc = "With load."};
  InConst<double> wheel_radius{"wheel_radius", "m", initial = 0.3, range(0.1, 1), doc = "Tyre under load."};
  InConst<double> start_speed{"start_speed", "m/s", initial = 0.0, range(0, 60), doc = "Speed at init."};
  Resource road{"road", shared, doc = "Script of metres:grade, straight lines between; \"0:0\" is level."};

  Outcome init() {
    if (!(*start_speed >= 0 && *start_speed <= 60)) return fault("start_speed is 0 to 60 m/s");
    car_.place(*start_speed);
    return reinit();
  }
  // Changes load, wheels or road and keeps place and speed.
  Outcome reinit() {
    const char* const too_steep = "a grade of the road is outside -0.3 to 0.3";
    if (const char* wrong = grade_.read(road.text(), -0.3, 0.3, too_steep)) return fault(wrong);
    if (!(*mass >= 500 && *mass <= 40000)) return fault("mass is 500 to 40000 kg");
    if (!(*wheel_radius >= 0.1 && *wheel_radius <= 1)) return fault("wheel_radius is 0.1 to 1 m");
    car_.refit({.mass = *mass, .wheel_radius = *wheel_radius});
    return ok();
  }
  // A car that replaces another continues at the last published place and speed of that car.
  void on() {
    const bool has_predecessor = xw.inherited() != kNever && speed.inherited() != kNever;
    const bool is_elsewhere = *xw != car_.wheel_angle() || *speed != car_.speed() * 3.6;
    if (has_predecessor && is_elsewhere && std::isfinite(*xw) && std::isfinite(*speed)) car_.resume(*speed / 3.6, *xw);
    *coasts = false;
    publish();
  }

 protected:
  /// For cycle: advances by `dt` in steps of at most 5 ms. `drive(h)` returns the drive force of a step of length h.
  /// `brake` is as in CarModel::step.
  template <class Drive>
  void roll(double dt, double brake, Drive drive) {
    const double n = math::ceil(dt / 5e-3), h = dt / n;
    for (double i = 0; i < n; ++i) car_.step(drive(h), brake, grade_.line(car_.distance()), h);
    publish();
  }
  /// m/s.
  double present_speed() const { return car_.speed(); }

 private:
  void publish() {
    *xw = car_.wheel_angle();
    *speed = car_.speed() * 3.6;
    *grade = grade_.line(car_.distance());
  }

  Script grade_;
  CarModel car_;
};

}  // namespace chimera::library
