// SPDX-License-Identifier: Apache-2.0
// The speed control of the cruise control (2000 paper, figure 17): how much force the car needs.
#include <algorithm>
#include <cmath>

#include "chimera/task/component.h"
#include "library/control/pi.h"

using namespace chimera;

namespace {

struct Control {
  In<double> vr{"vr", "m/s", doc = "Speed to hold; 0: the control is off."};
  In<double> vz{"vz", "m/s", doc = "Measured speed."};
  Out<double> fd{"fd", "N", initial = 0.0, safety, range(-20000, 20000), doc = "Force wanted; below 0 to brake."};
  InConst<double> kp{"kp", "N.s/m", initial = 2500.0, range(0, 1e6), doc = "Gain of the speed error."};
  InConst<double> ki{"ki", "N/m", initial = 600.0, range(0, 1e6), doc = "Gain of its integral."};
  InConst<double> drive_max{"drive_max", "N", initial = 2280.0, range(0, 20000), doc = "The most it asks for."};
  InConst<double> brake_max{"brake_max", "N", initial = 4000.0, range(0, 20000), doc = "The most it brakes with."};

  Outcome init() {
    if (!(*drive_max >= 0 && *drive_max <= 20000) || !(*brake_max >= 0 && *brake_max <= 20000))
      return fault("drive_max and brake_max are 0 to 20000 N");
    if (!(*kp >= 0 && *kp <= 1e6) || !(*ki >= 0 && *ki <= 1e6)) return fault("kp and ki are 0 to 1e6");
    return ok();
  }
  Outcome reinit() { return init(); }
  // Bumpless: goes on from the force that is handed over. Not before the first cycle, because a speed made by
  // differences is known only then. A force of 0 is nobody to go on from, and an older one belongs to another speed.
  void on() {
    pi_.start(0);
    if (fd.is_outdated()) *fd = 0;
    takes_over_ = std::isfinite(*fd) && *fd != 0;
  }
  Outcome cycle(Cycle c) {
    if (c.illegal()) return ok();  // nobody follows fd: the error means nothing, do not integrate it
    if (!std::isfinite(*vr) || !std::isfinite(*vz)) return fault("vr or vz is not finite");
    const bool takes_over = takes_over_;
    takes_over_ = false;
    if (*vr > 0) {
      if (takes_over) pi_.start(std::clamp(*fd - *kp * (*vr - *vz), -*brake_max, *drive_max));
      *fd = pi_.step(*kp, *ki, *vr - *vz, c.dt(), -*brake_max, *drive_max);
    } else {
      pi_.start(0);
      *fd = 0;
    }
    return ok();
  }

 private:
  library::Pi pi_;
  bool takes_over_ = false;
};

CHIMERA_COMPONENT(Control, "control", "Holds the speed of a car: PI with limits and anti-windup.", rate = 50.0,
                  source = "2000 paper, section 6; Astrom and Hagglund 2006");

}  // namespace
