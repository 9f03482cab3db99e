// SPDX-License-Identifier: Apache-2.0
// The physical world of the cruise control (2000 paper, section 6): a car with a combustion engine on a hilly road.
#include <algorithm>
#include <cmath>

#include "chimera/task/component.h"
#include "library/car/car_model.h"
#include "library/script/script.h"

using namespace chimera;

namespace {

struct Car {
  In<double> gas{"gas", "1", doc = "Throttle, 0 closed to 1 open."};
  In<double> fb{"fb", "N", doc = "Brake force at the wheels, 0 or more."};
  Out<double> xw{"xw", "rad", doc = "Angle of a wheel since init, forward positive."};
  Out<double> speed{"speed", "km/h", doc = "True speed, for judging; no module of the control reads it."};
  Out<double> grade{"grade", "1", doc = "Rise over run where the car is."};
  InConst<double> mass{"mass", "kg", initial = 1600.0, range(500, 40000), doc = "With load."};
  InConst<double> wheel_radius{"wheel_radius", "m", initial = 0.3, range(0.1, 1), doc = "Of the tyre under load."};
  InConst<double> start_speed{"start_speed", "m/s", initial = 0.0, range(0, 60), doc = "At init."};
  Resource road{"road", doc = "Script of metres:grade, straight lines between; \"0:0\" is level."};

  Outcome init() {
    if (!(*start_speed >= 0 && *start_speed <= 60)) return fault("start_speed is 0 to 60 m/s");
    car_.place(*start_speed);
    opening_ = 0;
    return reinit();
  }
  // Another load, other wheels or another road, where the car is and at its speed.
  Outcome reinit() {
    if (const char* wrong = grade_.read(road.text())) return fault(wrong);
    if (grade_.least() < -0.3 || grade_.greatest() > 0.3) return fault("a grade of the road is outside -0.3 to 0.3");
    if (!(*mass >= 500 && *mass <= 40000)) return fault("mass is 500 to 40000 kg");
    if (!(*wheel_radius >= 0.1 && *wheel_radius <= 1)) return fault("wheel_radius is 0.1 to 1 m");
    car_.refit({.mass = *mass, .wheel_radius = *wheel_radius});
    return ok();
  }
  void on() { publish(); }
  Outcome cycle(Cycle c) {
    if (!std::isfinite(*gas) || !std::isfinite(*fb)) return fault("gas or fb is not finite");
    // Whoever drives when the configuration is illegal takes the foot off the gas and rolls.
    const double wanted = c.illegal() ? 0 : std::clamp(*gas, 0.0, 1.0), brake = c.illegal() ? 0 : std::fmax(0, *fb);
    const double n = std::ceil(c.dt() / 5e-3), h = c.dt() / n;
    for (double i = 0; i < n; ++i) {
      opening_ += (wanted - opening_) * h / (engine_.lag + h);
      car_.step(engine_.force(opening_, car_.speed()), brake, grade_.line(car_.distance()), h);
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
  library::CarEngine engine_;
  library::CarModel car_;
  double opening_ = 0;
};

CHIMERA_COMPONENT(Car, "car", "Simulated car with combustion engine, brakes and a hilly road.", rate = 100.0,
                  source = "Astrom and Murray 2008, chapter 3");

}  // namespace
