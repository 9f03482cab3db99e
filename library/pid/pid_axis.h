// SPDX-License-Identifier: Apache-2.0
// One axis of a PID controller on an error and its rate
// (Astrom and Hagglund, Advanced PID Control, 2006, sections 3.4 and 3.5).
#pragma once

#include <algorithm>

namespace chimera::library {

/// Gains of one axis, for an output in X and an error in U (N.m and rad for a joint).
struct PidGains {
  double kp = 0;  ///< X/U
  double ki = 0;  ///< X/(U.s)
  double kd = 0;  ///< X.s/U
};

/// u = kp e + kd F(de) + I, cut at low and high. F is a first-order filter of the rate of the error, dI/dt = ki e.
/// Anti-windup by conditional integration: an e that would drive u across a limit moves I only until u meets the limit.
/// This needs no tracking gain, and ki may change while the axis runs. Context: cycle; wait-free.
class PidAxis {
 public:
  /// Sets the integral so that the first output is `output`.
  void start(const PidGains& gains, double error, double error_rate, double output) noexcept {
    filtered_ = error_rate;
    integral_ = output - gains.kp * error - gains.kd * error_rate;
  }

  /// Advances by `dt` seconds and returns the output. `filter_time` (s) belongs to F; 0: no filter. Requires: dt > 0,
  /// low <= high.
  double step(const PidGains& gains, double error, double error_rate, double dt, double filter_time, double low,
              double high) noexcept {
    filtered_ += (error_rate - filtered_) * dt / (filter_time + dt);
    const double increment = gains.ki * error * dt;
    const double before = gains.kp * error + gains.kd * filtered_ + integral_, wanted = before + increment;
    if (wanted > high && increment > 0)
      integral_ += std::max(high - before, 0.0);
    else if (wanted < low && increment < 0)
      integral_ += std::min(low - before, 0.0);
    else
      integral_ += increment;
    return std::clamp(wanted, low, high);
  }

  double integral() const noexcept { return integral_; }

 private:
  double integral_ = 0;
  double filtered_ = 0;
};

}  // namespace chimera::library
