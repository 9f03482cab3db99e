// SPDX-License-Identifier: Apache-2.0
// Simulates the car of the cruise control (2000 paper, section 6): a combustion engine on a hilly road.
#include <algorithm>
#include <cmath>

#include "library/car/rolling_car.h"

using namespace chimera;

namespace {

struct Car : library::RollingCar {
  In<double> gas{"gas", "1", doc = "Throttle, 0 closed to 1 open."};
  In<double> fb{"fb", "N", doc = "Brake force at the wheels, 0 or more."};

  Outcome init() {
    opening_ = 0;
    return RollingCar::init();
  }
  Outcome cycle(Cycle c) {
    if (!std::isfinite(*gas) || !std::isfinite(*fb)) return fault("gas or fb is not finite");
    // An illegal configuration releases gas and brake, and the car rolls.
    const double wanted = c.illegal() ? 0 : std::clamp(*gas, 0.0, 1.0), brake = c.illegal() ? 0 : (*fb > 0 ? *fb : 0.0);
    roll(c.dt(), brake, [&](double h) {
      opening_ += (wanted - opening_) * h / (engine_.lag + h);
      return engine_.force(opening_, present_speed());
    });
    *coasts = c.illegal() && opening_ < 0.01;
    return ok();
  }

 private:
  library::CarEngine engine_;
  double opening_ = 0;
};

CHIMERA_COMPONENT(Car, "car", "Simulated car with combustion engine, brakes and a hilly road.", rate = 100.0,
                  source = "Astrom and Murray 2008, chapter 3");

}  // namespace
