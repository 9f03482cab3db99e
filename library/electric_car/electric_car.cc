// SPDX-License-Identifier: Apache-2.0
// Simulates the car of the 2000 paper's direct-drive variant: one motor drives and brakes.
#include <algorithm>
#include <cmath>

#include "library/car/rolling_car.h"

using namespace chimera;

namespace {

struct ElectricCar : library::RollingCar {
  In<double> fm{"fm", "N", doc = "Wanted motor force; below 0 brakes."};
  InConst<double> force_max{"force_max", "N", initial = 5000.0, range(0, 50000),
                            doc = "Limit of the motor, driving and braking."};
  InConst<double> power_max{"power_max", "W", initial = 80e3, range(0, 1e6),
                            doc = "Limit of the motor, driving and braking."};

  Outcome init() { return wrong_motor() == nullptr ? RollingCar::init() : fault(wrong_motor()); }
  Outcome reinit() { return wrong_motor() == nullptr ? RollingCar::reinit() : fault(wrong_motor()); }
  Outcome cycle(Cycle c) {
    if (!std::isfinite(*fm)) return fault("fm is not finite");
    const double wanted = c.illegal() ? 0 : *fm;
    roll(c.dt(), 0, [&](double) {
      const double limit = std::min(*force_max, *power_max / std::max(1.0, std::abs(present_speed())));
      return std::clamp(wanted, -limit, limit);
    });
    *coasts = c.illegal();
    return ok();
  }

 private:
  const char* wrong_motor() const {
    if (!(*force_max >= 0 && *force_max <= 50000)) return "force_max is 0 to 50000 N";
    if (!(*power_max >= 0 && *power_max <= 1e6)) return "power_max is 0 to 1e6 W";
    return nullptr;
  }
};

CHIMERA_COMPONENT(ElectricCar, "electric_car", "Simulated car whose one motor drives and brakes.", rate = 100.0,
                  source = "2000 paper, section 6; Astrom and Murray 2008, chapter 3");

}  // namespace
