// SPDX-License-Identifier: Apache-2.0
// The speed control of the 2000 paper's cruise control (figure 17): how much force a car needs to hold a speed.
#pragma once

#include <algorithm>
#include <cmath>
#include <utility>

#include "library/control/pi.h"

namespace chimera::library {

/// Context: cycle; wait-free.
class SpeedControl {
 public:
  struct Gains {
    double kp, ki;                ///< N.s/m, N/m
    double drive_max, brake_max;  ///< N: the force lies in [-brake_max, drive_max]
  };

  /// The text of a fault; null: the gains are in order.
  static const char* fault_in(const Gains& gains) noexcept {
    if (!(gains.drive_max >= 0 && gains.drive_max <= 20000) || !(gains.brake_max >= 0 && gains.brake_max <= 20000))
      return "drive_max and brake_max are 0 to 20000 N";
    if (!(gains.kp >= 0 && gains.kp <= 1e6) || !(gains.ki >= 0 && gains.ki <= 1e6)) return "kp and ki are 0 to 1e6";
    return nullptr;
  }

  /// Goes on from `force`, bumpless. Not before the first step, because a speed made by differences is known only then.
  /// A force of 0 is nobody to go on from.
  void start(double force) noexcept {
    pi_.start(0);
    taken_over_ = std::isfinite(force) ? force : 0;
  }

  /// The force for the next `dt` seconds, from the speed wanted (0: the control is off) and the speed measured.
  double step(const Gains& gains, double wanted, double measured, double dt) noexcept {
    const double force = std::exchange(taken_over_, 0);
    if (!(wanted > 0)) {
      pi_.start(0);
      return 0;
    }
    const double error = wanted - measured;
    if (force != 0) pi_.start(std::clamp(force - gains.kp * error, -gains.brake_max, gains.drive_max));
    return pi_.step(gains.kp, gains.ki, error, dt, -gains.brake_max, gains.drive_max);
  }

 private:
  Pi pi_;
  double taken_over_ = 0;  // N, until the first step
};

}  // namespace chimera::library
