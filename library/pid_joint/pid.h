// SPDX-License-Identifier: Apache-2.0
// One axis of a PID controller on position and velocity errors
// (Astrom and Hagglund, Advanced PID Control, 2006, sections 3.4 and 3.5).
#pragma once

#include <algorithm>

namespace chimera::library {

/// Gains of one axis, for torque in N.m and angle in rad.
struct PidGains {
  double kp = 0;  ///< N.m/rad
  double ki = 0;  ///< N.m/(rad.s)
  double kd = 0;  ///< N.m.s/rad
};

/// u = kp e + kd F(de) + I, cut at +-limit; F is a first-order filter of the velocity error, dI/dt = ki e.
/// Anti-windup by conditional integration: I stands still while u is cut and e would drive it further out. It
/// needs no tracking gain of its own, and the ki of every axis may be tuned while it runs. Context: cycle; wait-free.
class PidAxis {
 public:
  /// Starts so that the first output is `output`: the integral takes what the other terms do not give.
  void start(const PidGains& gains, double error, double error_rate, double output) noexcept {
    filtered_ = error_rate;
    integral_ = output - gains.kp * error - gains.kd * error_rate;
  }

  /// The output after `dt` seconds more. `filter_time` (s) is that of F; 0 = no filter. Requires: dt > 0, limit >= 0.
  double step(const PidGains& gains, double error, double error_rate, double dt, double filter_time,
              double limit) noexcept {
    filtered_ += (error_rate - filtered_) * dt / (filter_time + dt);
    const double increment = gains.ki * error * dt;
    const double wanted = gains.kp * error + gains.kd * filtered_ + integral_ + increment;
    const bool drives_out = (wanted > limit && increment > 0) || (wanted < -limit && increment < 0);
    if (!drives_out) integral_ += increment;
    return std::clamp(drives_out ? wanted - increment : wanted, -limit, limit);
  }

  double integral() const noexcept { return integral_; }

 private:
  double integral_ = 0;
  double filtered_ = 0;
};

}  // namespace chimera::library
