// SPDX-License-Identifier: Apache-2.0
// Filters of first and second order with trapezoidal integrators: the bilinear transform with prewarping. Their states
// are those of the analog circuit, so that the time step may change while the filter runs (Zavalishin, The Art of VA
// Filter Design, rev. 2.1.2, 2018, sections 3.9 and 4.4).
#pragma once

#include "chimera/base/math.h"

namespace chimera::library {

/// Largest frequency times time step. The filter treats a larger product as this one.
inline constexpr double kMostTurns = 0.49;

/// g = tan(pi f dt): the gain that puts the analog frequency 1 exactly at f (Hz) for steps of dt (s).
/// f dt is cut at kMostTurns, because the transform ends at half the rate. Context: cycle; wait-free.
inline double prewarped(double frequency, double dt) noexcept {
  const double turns = frequency * dt;
  return math::tan(math::kPi * (turns < kMostTurns ? turns : kMostTurns));
}

/// 1 / (s + 1). Context: cycle; wait-free.
class FirstOrder {
 public:
  /// Sets the state for a constant input `x`.
  void settle(double x) noexcept { low_ = x, slope_ = 0; }
  double lowpass(double x, double g) noexcept {
    low_ = (g * (x + slope_) + low_) / (1 + g);
    slope_ = x - low_;
    return low_;
  }

 private:
  double low_ = 0;    // integrator
  double slope_ = 0;  // input of the integrator
};

/// Denominator s^2 + k s + 1, numerator 1 (lowpass) or s^2 + 1 (notch); k = 1/Q. Context: cycle; wait-free.
class SecondOrder {
 public:
  void settle(double x) noexcept { high_ = band_ = 0, low_ = x; }
  double lowpass(double x, double g, double k) noexcept {
    step(x, g, k);
    return low_;
  }
  double notch(double x, double g, double k) noexcept {
    step(x, g, k);
    return x - k * band_;
  }

 private:
  // Each integrator adds half a step of its last input and half a step of its present input, both with the present
  // length of a step. The state does not depend on a step length.
  void step(double x, double g, double k) noexcept {
    const double band = band_ + g * high_, low = low_ + g * band_;
    high_ = (x - (k + g) * band - low) / (1 + g * (k + g));
    band_ = band + g * high_;
    low_ = low + g * band_;
  }

  double high_ = 0, band_ = 0, low_ = 0;
};

}  // namespace chimera::library
