// SPDX-License-Identifier: Apache-2.0
// Speed control of the cruise control (2000 paper, figure 17 bottom): computes the force that holds the speed.
#include <cmath>

#include "chimera/task/component.h"
#include "library/control/speed_control.h"
#include "library/signals/input.h"

using namespace chimera;

namespace {

struct Control {
  In<double> vr{"vr", "m/s", doc = "Speed to hold; 0: off."};
  In<double> vz{"vz", "m/s", doc = "Measured speed."};
  Out<double> fd{"fd", "N", initial = 0.0, safety, range(-20000, 20000), doc = "Wanted force; below 0 brakes."};
  InConst<double> kp{"kp", "N.s/m", initial = 2500.0, range(0, 1e6), doc = "Gain of the speed error."};
  InConst<double> ki{"ki", "N/m", initial = 600.0, range(0, 1e6), doc = "Gain of its integral."};
  InConst<double> drive_max{"drive_max", "N", initial = 2280.0, range(0, 20000), doc = "Largest force."};
  InConst<double> brake_max{"brake_max", "N", initial = 4000.0, range(0, 20000), doc = "Largest braking force."};

  Outcome init() {
    const char* const wrong = library::SpeedControl::fault_in(gains());
    return wrong == nullptr ? ok() : fault(wrong);
  }
  Outcome reinit() { return init(); }
  // An outdated force belongs to another speed.
  void on() {
    if (fd.is_outdated()) *fd = 0;
    control_.start(*fd);
  }
  Outcome cycle(Cycle c) {
    if (c.illegal()) return ok();  // the car does not follow fd, so the error must not be integrated
    if (!std::isfinite(*vr) || !std::isfinite(*vz)) return library::unfit("vr or vz is not finite", vr, vz);
    *fd = control_.step(gains(), *vr, *vz, c.dt());
    return ok();
  }
  bool error() { return true; }

 private:
  library::SpeedControl::Gains gains() const { return {*kp, *ki, *drive_max, *brake_max}; }

  library::SpeedControl control_;
};

CHIMERA_COMPONENT(Control, "control", "Holds the speed of a car: PI with limits and anti-windup.", rate = 50.0,
                  source = "2000 paper, section 6; Astrom and Hagglund 2006");

}  // namespace
