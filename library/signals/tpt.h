// SPDX-License-Identifier: Apache-2.0
// Filters of first and second order whose integrators are trapezoidal: the bilinear transform with prewarping, in a
// form whose states are those of the analog circuit, so that the step of time may change while the filter runs
// (Zavalishin, The Art of VA Filter Design, rev. 2.1.2, 2018, sections 3.9 and 4.4).
#pragma once

#include "chimera/base/math.h"

namespace chimera::library {

/// Frequency times step of time that is still followed; beyond, the filter acts as if it were there.
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
  /// As if the input had been `x` for ever.
  void settle(double x) noexcept { state_ = x; }
  double lowpass(double x, double g) noexcept {
    const double v = (x - state_) * g / (1 + g);
    const double y = v + state_;
    state_ = y + v;
    return y;
  }

 private:
  double state_ = 0;
};

/// s^2 + k s + 1 below, and 1 (low) or s^2 + 1 (notch) above; k = 1/Q. Context: cycle; wait-free.
class SecondOrder {
 public:
  void settle(double x) noexcept { band_ = 0, low_ = x; }
  double lowpass(double x, double g, double k) noexcept {
    step(x, g, k);
    return low_out_;
  }
  double notch(double x, double g, double k) noexcept {
    step(x, g, k);
    return x - k * band_out_;
  }

 private:
  void step(double x, double g, double k) noexcept {
    const double high = (x - (k + g) * band_ - low_) / (1 + g * (k + g));
    band_out_ = g * high + band_;
    low_out_ = g * band_out_ + low_;
    band_ = g * high + band_out_;
    low_ = g * band_out_ + low_out_;
  }

  double band_ = 0, low_ = 0;          // integrators
  double band_out_ = 0, low_out_ = 0;  // of the last step
};

}  // namespace chimera::library
