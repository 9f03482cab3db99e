// SPDX-License-Identifier: Apache-2.0
// A PI controller with limits (Astrom and Hagglund, Advanced PID Control, 2006, section 3.5).
#pragma once

#include <algorithm>

namespace chimera::library {

/// u = kp e + I within [low, high]; I holds while u is cut and e would drive it further out. A driver who overrides the
/// control for a minute therefore leaves no error of that minute in I. Context: cycle; wait-free.
class Pi {
 public:
  void start(double integral) noexcept { integral_ = integral; }

  /// Requires: dt >= 0, low <= high.
  double step(double kp, double ki, double error, double dt, double low, double high) noexcept {
    const double increment = ki * error * dt, wanted = kp * error + integral_ + increment;
    const bool drives_out = (wanted > high && increment > 0) || (wanted < low && increment < 0);
    if (!drives_out) integral_ += increment;
    return std::clamp(drives_out ? wanted - increment : wanted, low, high);
  }

  double integral() const noexcept { return integral_; }

 private:
  double integral_ = 0;
};

}  // namespace chimera::library
