// SPDX-License-Identifier: Apache-2.0
// The car of the 2000 paper's direct-drive variant: one motor force, driving and braking.
#include <algorithm>
#include <cmath>

#include "chimera/task/component.h"
#include "library/car/car_model.h"
#include "library/script/script.h"

using namespace chimera;

namespace {

struct ElectricCar {
  In<double> fm{"fm", "N", doc = "Force wanted of the motor; below 0 it brakes."};
  Out<double> xw{"xw", "rad", doc = "Angle of a wheel since init, forward positive."};
  Out<double> speed{"speed", "km/h", doc = "True speed, for judging; no module of the control reads it."};
  Out<double> grade{"grade", "1", doc = "Rise over run where the car is."};
  InConst<double> mass{"mass", "kg", initial = 1600.0, range(500, 40000), doc = "With load."};
  InConst<double> wheel_radius{"wheel_radius", "m", initial = 0.3, range(0.1, 1), doc = "Of the tyre under load."};
  InConst<double> start_speed{"start_speed", "m/s", initial = 0.0, range(0, 60), doc = "At init."};
  InConst<double> force_max{"force_max", "N", initial = 5000.0, range(0, 50000), doc = "Of the motor, either way."};
  InConst<double> power_max{"power_max", "W", initial = 80e3, range(0, 1e6), doc = "Of the motor, either way."};
  Resource road{"road", doc = "Script of metres:grade, straight lines between; \"0:0\" is level."};

  Outcome init() {
    if (!(*start_speed >= 0 && *start_speed <= 60)) return fault("start_speed is 0 to 60 m/s");
    car_.place(*start_speed);
    return reinit();
  }
  // Another load, other wheels or another road, where the car is and at its speed.
  Outcome reinit() {
    if (const char* wrong = grade_.read(road.text())) return fault(wrong);
    if (grade_.least() < -0.3 || grade_.greatest() > 0.3) return fault("a grade of the road is outside -0.3 to 0.3");
    if (!(*mass >= 500 && *mass <= 40000)) return fault("mass is 500 to 40000 kg");
    if (!(*wheel_radius >= 0.1 && *wheel_radius <= 1)) return fault("wheel_radius is 0.1 to 1 m");
    if (!(*force_max >= 0 && *force_max <= 50000)) return fault("force_max is 0 to 50000 N");
    if (!(*power_max >= 0 && *power_max <= 1e6)) return fault("power_max is 0 to 1e6 W");
    car_.refit({.mass = *mass, .wheel_radius = *wheel_radius});
    return ok();
  }
  void on() { publish(); }
  Outcome cycle(Cycle c) {
    if (!std::isfinite(*fm)) return fault("fm is not finite");
    const double wanted = c.illegal() ? 0 : *fm;
    const double n = std::ceil(c.dt() / 5e-3), h = c.dt() / n;
    for (double i = 0; i < n; ++i) {
      const double limit = std::min(*force_max, *power_max / std::max(1.0, std::abs(car_.speed())));
      car_.step(std::clamp(wanted, -limit, limit), 0, grade_.line(car_.distance()), h);
    }
    publish();
    return ok();
  }

 private:
  void publish() {
    *xw = car_.wheel_angle();
    *speed = car_.speed() * 3.6;
    *grade = grade_.line(car_.distance());
  }

  library::Script grade_;
  library::CarModel car_;
};

CHIMERA_COMPONENT(ElectricCar, "electric_car", "Simulated car whose one motor drives and brakes.", rate = 100.0,
                  source = "2000 paper, section 6; Astrom and Murray 2008, chapter 3");

}  // namespace
