// SPDX-License-Identifier: Apache-2.0
// The wheel position resolver of the cruise control (2000 paper, figure 15).
#include <numbers>

#include "chimera/base/math.h"
#include "chimera/task/component.h"

using namespace chimera;

namespace {

struct Position {
  In<double> xw{"xw", "rad", doc = "Angle of the wheel since on."};
  Out<double> xz{"xz", "m", doc = "Way of the car since on, in whole counts."};
  InConst<double> wheel_radius{"wheel_radius", "m", initial = 0.3, range(0.1, 1), doc = "Tyre under load."};
  InConst<std::int32_t> counts{"counts", "1", initial = 65536, range(1, 1e9), doc = "Counts in one turn."};

  Outcome init() {
    if (*counts < 1 || !(*wheel_radius > 0)) return fault("counts and wheel_radius must be above 0");
    return ok();
  }
  Outcome reinit() { return init(); }
  void on() { cycle(); }
  void cycle() {
    const double count = 2 * std::numbers::pi / *counts;
    *xz = math::floor(*xw / count) * count * *wheel_radius;
  }
};

CHIMERA_COMPONENT(Position, "position", "Wheel position resolver: way from the angle of a wheel.", rate = 50.0,
                  source = "2000 paper, section 6");

}  // namespace
