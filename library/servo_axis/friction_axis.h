// SPDX-License-Identifier: Apache-2.0
// A rotor with viscous and Coulomb friction under a torque that is constant during each step, in closed form.
#pragma once

#include "chimera/base/math.h"

namespace chimera::library {

/// Properties of an axis. Requires: inertia > 0, friction >= 0.
struct AxisBody {
  double inertia = 1;  ///< J, kg.m2
  double viscous = 0;  ///< b, N.m.s/rad
  double coulomb = 0;  ///< c, N.m; at rest it holds against any torque up to this
};

/// 1 / n. A quotient costs ten times a product where numbers of type float64 are computed in software.
struct Inverses {
  double of[22] = {};
  constexpr Inverses() noexcept {
    for (int n = 1; n < 22; ++n) of[n] = 1.0 / n;
  }
};
inline constexpr Inverses kInverse;

/// J dw/dt = torque - b w - c sgn w. While w keeps its sign, that is dw/dt = a - k w, whose solution after a time t is
/// w e^-kt + a g(t), with g(t) = (1 - e^-kt) / k. Context: cycle; wait-free.
class FrictionAxis {
 public:
  void place(double position, double velocity) noexcept { position_ = position, velocity_ = velocity; }
  void refit(const AxisBody& body) noexcept {
    body_ = body;
    whole_ = {};
  }
  /// Advances by `dt` seconds. Requires: dt > 0, a finite torque.
  void step(double torque, double dt) noexcept {
    if (dt != whole_.time) whole_ = law(dt);  // once, as long as the period stays
    double sign = direction(torque);
    if (sign == 0) return;
    const double acceleration = (torque - sign * body_.coulomb) / body_.inertia;
    const bool brakes = velocity_ != 0 && acceleration * sign < 0;
    if (!brakes || whole_.velocity(velocity_, acceleration) * sign > 0) return advance(whole_, acceleration);
    // It stops within the step. Then it stays, or turns back for the rest.
    const double stop = time_to_stop(acceleration);
    advance(law(stop < dt ? stop : dt), acceleration);
    velocity_ = 0;
    sign = direction(torque);
    if (sign != 0 && stop < dt) advance(law(dt - stop), (torque - sign * body_.coulomb) / body_.inertia);
  }

  double position() const noexcept { return position_; }  ///< rad
  double velocity() const noexcept { return velocity_; }  ///< rad/s

 private:
  /// The effect of a time on velocity and position.
  struct Law {
    double time = 0, decay = 1;  // t; e^-kt
    double g = 0, h = 0;         // g(t), s; its integral (t - g) / k, s2
    double velocity(double before, double acceleration) const noexcept { return before * decay + acceleration * g; }
  };

  Law law(double time) const noexcept {
    const double x = body_.viscous / body_.inertia * time;
    if (x >= 0.5) {
      const double decay = math::exp(-x), g = time * (1 - decay) / x;
      return {time, decay, g, time * (time - g) / x};
    }
    double rest = 0;  // (x - 1 + e^-x) / x^2 by its series, also where x is 0
    for (int n = 16; n > 1; --n) rest = (1 - x * rest) * kInverse.of[n];
    const double share = 1 - x * rest;  // (1 - e^-x) / x
    return {time, 1 - x * share, time * share, time * time * rest};
  }
  /// The sign of the motion that is there or begins; 0: friction holds the axis.
  double direction(double torque) const noexcept {
    if (velocity_ != 0) return velocity_ > 0 ? 1 : -1;
    if (math::fabs(torque) <= body_.coulomb) return 0;
    return torque > 0 ? 1 : -1;
  }
  /// Requires: an acceleration against the velocity. Solves w e^-kt + a g(t) = 0.
  double time_to_stop(double acceleration) const noexcept {
    const double time = -velocity_ / acceleration, y = body_.viscous / body_.inertia * time;
    if (y >= 0.5) return time * math::log(1 + y) / y;
    const double z = y / (2 + y);  // log(1 + y) = 2 (z + z^3/3 + z^5/5 + ...)
    double sum = 0;
    for (int n = 21; n > 0; n -= 2) sum = sum * z * z + kInverse.of[n];
    return time * sum * 2 / (2 + y);
  }
  void advance(const Law& law, double acceleration) noexcept {
    position_ += velocity_ * law.g + acceleration * law.h;
    velocity_ = law.velocity(velocity_, acceleration);
  }

  AxisBody body_;
  Law whole_;  // of a whole cycle
  double position_ = 0, velocity_ = 0;
};

}  // namespace chimera::library
