// SPDX-License-Identifier: Apache-2.0
// Speedometer and odometer of the cruise control (2000 paper, figure 15).
#include "chimera/base/math.h"
#include "chimera/task/component.h"

using namespace chimera;

namespace {

struct Dashboard {
  In<double> vz{"vz", "m/s", doc = "Measured speed."};
  In<double> xz{"xz", "m", doc = "Way of the car since on."};
  Out<double> speedometer{"speedometer", "km/h", doc = "In whole km/h."};
  Out<double> odometer{"odometer", "km", doc = "In tenths of a km, rounded down."};

  void on() { cycle(); }
  void cycle() {
    *speedometer = math::round(math::fabs(*vz) * 3.6);
    *odometer = math::floor(*xz / 100) / 10;
  }
};

CHIMERA_COMPONENT(Dashboard, "dashboard", "Speedometer and odometer.", rate = 10.0, source = "2000 paper, section 6");

}  // namespace
