// SPDX-License-Identifier: Apache-2.0
// @NAME@_control: brings the speed to what is wanted, without a lasting error.
#include <algorithm>

#include "chimera/task/component.h"

using namespace chimera;

struct @TYPE@ControlComponent {
  In<double>  speed{"speed", "rad/s"};
  In<double>  wanted{"wanted", "rad/s"};
  In<double>  kp{"kp", "V.s/rad", range(0, 1e6)};
  In<double>  ki{"ki", "V/rad", initial = 0.0, range(0, 1e6)};  // 0 unless it is connected
  Out<double> u{"u", "V", initial = 0.0, safety, range(-24, 24), doc = "kp e + ki times the integral of e"};

  void on() { integral_ = 0; }
  void cycle(Cycle c) {
    const double error = *wanted - *speed;
    integral_ = std::clamp(integral_ + *ki * error * c.dt(), -24.0, 24.0);  // no more than can be put out
    *u = std::clamp(*kp * error + integral_, -24.0, 24.0);
  }
  double integral_ = 0;
};
CHIMERA_COMPONENT(@TYPE@ControlComponent, "@NAME@_control", "A PI controller of a speed.", rate = 1000.0);
