// SPDX-License-Identifier: Apache-2.0
// The quintic to rest: the polynomial of least degree with given velocity and acceleration at its start and none at its
// end (Craig, Introduction to Robotics, 3rd ed., section 7.3).
#pragma once

namespace chimera::library {

/// A position with its first two derivatives, in the unit U of the path, U/s and U/s2.
struct Motion {
  double position = 0;
  double velocity = 0;
  double acceleration = 0;
};

/// s(u) = 10 u^3 - 15 u^4 + 6 u^5 between two positions in `duration` seconds. Peaks: velocity 1.875 d/T halfway,
/// acceleration 10/sqrt(3) d/T2. A start in motion adds v T (u - 6 u^3 + 8 u^4 - 3 u^5) + a T^2 / 2 u^2 (1 - u)^3.
/// Requires: duration > 0. Context: cycle; wait-free.
struct Quintic {
  double from = 0;
  double to = 0;
  double duration = 1;
  double velocity = 0;      ///< at the start
  double acceleration = 0;  ///< at the start

  /// Motion at time t (s): that of the start before 0, at rest in `to` after the duration.
  Motion at(double t) const noexcept {
    if (!(t > 0)) return {from, velocity, acceleration};
    if (t >= duration) return {to, 0, 0};
    const double u = t / duration, d = to - from, v = 1 - u;
    const Motion motion{from + d * u * u * u * (10 + u * (6 * u - 15)),
                        d / duration * 30 * u * u * v * v,
                        d / (duration * duration) * 60 * u * v * (1 - 2 * u)};
    return velocity == 0 && acceleration == 0 ? motion : with_beginning(motion, u);
  }

  // Public, so that Quintic remains an aggregate.
  Motion with_beginning(const Motion& motion, double u) const noexcept {
    const double v = velocity, a = acceleration, d = duration;
    return {motion.position + u * v * d * (1 + u * u * (u * (8 - 3 * u) - 6)) +
                a * d * d / 2 * u * u * (1 - u) * (1 - u) * (1 - u),
            motion.velocity + v * (1 + u * u * (u * (32 - 15 * u) - 18)) +
                a * d * u * (1 + u * (u * (6 - 2.5 * u) - 4.5)),
            motion.acceleration + v / d * u * (u * (96 - 60 * u) - 36) + a * (1 + u * (u * (18 - 10 * u) - 9))};
  }
};

}  // namespace chimera::library
