// SPDX-License-Identifier: Apache-2.0
// Speed control of the cruise control in one module with two outputs (2000 paper, figure 17 top).
#include <algorithm>
#include <cmath>

#include "chimera/task/component.h"
#include "library/control/speed_control.h"
#include "library/signals/input.h"

using namespace chimera;

namespace {

struct ControlPm {
  In<double> vr{"vr", "m/s", doc = "Speed to hold; 0: off."};
  In<double> vz{"vz", "m/s", doc = "Measured speed."};
  Out<double> fde{"fde", "N", initial = 0.0, safety, range(0, 20000), doc = "Wanted engine force."};
  Out<double> fdw{"fdw", "N", initial = 0.0, safety, range(0, 20000), doc = "Wanted brake force."};
  Out<double> fd{"fd", "N", initial = 0.0, safety, range(-20000, 20000),
                 doc = "fde less fdw, for a successor with one output."};
  InConst<double> kp{"kp", "N.s/m", initial = 2500.0, range(0, 1e6), doc = "Gain of the speed error."};
  InConst<double> ki{"ki", "N/m", initial = 600.0, range(0, 1e6), doc = "Gain of its integral."};
  InConst<double> drive_max{"drive_max", "N", initial = 2280.0, range(0, 20000), doc = "Largest force."};
  InConst<double> brake_max{"brake_max", "N", initial = 4000.0, range(0, 20000), doc = "Largest braking force."};

  Outcome init() {
    const char* const wrong = library::SpeedControl::fault_in(gains());
    return wrong == nullptr ? ok() : fault(wrong);
  }
  Outcome reinit() { return init(); }
  // Continues from the present forces of engine and brakes. An outdated force belongs to another speed.
  void on() {
    if (fde.is_outdated()) *fde = 0;
    if (fdw.is_outdated()) *fdw = 0;
    *fd = *fde - *fdw;
    control_.start(*fd);
  }
  Outcome cycle(Cycle c) {
    if (c.illegal()) return ok();  // the car does not follow the force, so the error must not be integrated
    if (!std::isfinite(*vr) || !std::isfinite(*vz)) return library::unfit("vr or vz is not finite", vr, vz);
    *fd = control_.step(gains(), *vr, *vz, c.dt());
    *fde = std::max(0.0, *fd);
    *fdw = std::max(0.0, -*fd);
    return ok();
  }
  bool error() { return true; }

 private:
  library::SpeedControl::Gains gains() const { return {*kp, *ki, *drive_max, *brake_max}; }

  library::SpeedControl control_;
};

CHIMERA_COMPONENT(ControlPm, "control_pm", "Holds the speed of a car by engine and brakes: control and split in one.",
                  rate = 50.0, source = "2000 paper, section 6, figure 17");

}  // namespace
