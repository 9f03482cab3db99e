// SPDX-License-Identifier: Apache-2.0
// Speed control of the 2000 paper's cruise control (figure 17): computes the force that holds the speed of a car.
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

  /// Returns the text of a fault, or null if the gains are valid.
  static const char* fault_in(const Gains& gains) noexcept {
    if (!(gains.drive_max >= 0 && gains.drive_max <= 20000) || !(gains.brake_max >= 0 && gains.brake_max <= 20000))
      return "drive_max and brake_max are 0 to 20000 N";
    if (!(gains.kp >= 0 && gains.kp <= 1e6) || !(gains.ki >= 0 && gains.ki <= 1e6)) return "kp and ki are 0 to 1e6";
    return nullptr;
  }

  /// Continues from `force` without a step. The first step applies it, because a speed from differences is unknown
  /// before. A force of 0 means that there is no predecessor.
  void start(double force) noexcept {
    pi_.start(0);
    taken_over_ = std::isfinite(force) ? force : 0;
  }

  /// Returns the force for the next `dt` seconds. `wanted` and `measured` are speeds; a wanted speed of 0 means off.
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
