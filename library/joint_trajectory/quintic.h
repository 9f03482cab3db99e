// SPDX-License-Identifier: Apache-2.0
// The quintic from rest to rest: the lowest polynomial whose velocity and acceleration vanish at both ends
// (Craig, Introduction to Robotics, 3rd ed., section 7.3).
#pragma once

namespace chimera::library {

/// A position with its first two derivatives, in the unit U of the path, U/s and U/s2.
struct Motion {
  double position = 0;
  double velocity = 0;
  double acceleration = 0;
};

/// s(u) = 10 u^3 - 15 u^4 + 6 u^5 between two positions in `duration` seconds.
/// Peaks: velocity 1.875 d/T halfway, acceleration 10/sqrt(3) d/T2. Requires: duration > 0. Context: cycle; wait-free.
struct Quintic {
  double from = 0;
  double to = 0;
  double duration = 1;

  /// The motion at time t (s): at rest in `from` before 0, at rest in `to` after the duration.
  Motion at(double t) const noexcept {
    if (!(t > 0)) return {from, 0, 0};
    if (t >= duration) return {to, 0, 0};
    const double u = t / duration, d = to - from, v = 1 - u;
    return {from + d * u * u * u * (10 + u * (6 * u - 15)),
            d / duration * 30 * u * u * v * v,
            d / (duration * duration) * 60 * u * v * (1 - 2 * u)};
  }
};

}  // namespace chimera::library
