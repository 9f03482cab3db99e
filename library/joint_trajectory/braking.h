// SPDX-License-Identifier: Apache-2.0
// Brakes a motion to rest in the least time within limits of acceleration and jerk: the acceleration goes to a constant
// deceleration, holds, and goes to 0 (Biagiotti and Melchiorri, Trajectory Planning for Automatic Machines and Robots,
// 2008, section 3.4).
#pragma once

#include <algorithm>
#include <cstddef>

#include "chimera/base/math.h"
#include "library/joint_trajectory/seven_segments.h"

namespace chimera::library {

/// One joint from a motion to rest. Velocity has no jump; with a limit of jerk acceleration has none either. An
/// acceleration that starts beyond its limit only falls. Context: cycle; wait-free.
class Braking {
 public:
  /// At rest at position 0.
  Braking() noexcept = default;
  Braking(const Motion& from, const MotionLimits& limits) noexcept {
    const double j = limits.jerk, a = from.acceleration;
    const bool has_jerk = j < kInfinite;
    const double left = has_jerk ? from.velocity + a * math::fabs(a) / (2 * j) : from.velocity;  // with a brought to 0
    if (left == 0 && from.velocity == 0) {
      phases_[2].start = {from.position, 0, 0};
      return;
    }
    const double sign = left < 0 ? -1 : 1;
    if (has_jerk) {
      plan(sign * from.velocity, sign * a, limits);
    } else {
      deceleration_ = limits.acceleration;
      times_[1] = sign * from.velocity / deceleration_;
    }
    phases_[0] = {{from.position, from.velocity, has_jerk ? a : -sign * deceleration_}, has_jerk ? -sign * j : 0};
    phases_[1].start = phases_[0].at(times_[0]);
    phases_[1].start.acceleration = -sign * deceleration_;
    phases_[2] = {phases_[1].at(times_[1]), has_jerk ? sign * j : 0};
  }

  /// Time to rest, in s.
  double duration() const noexcept { return times_[0] + times_[1] + times_[2]; }
  /// Position at rest.
  double rest() const noexcept { return phases_[2].at(times_[2]).position; }
  /// Motion at time t (s), t >= 0. It is at rest after the duration.
  Motion at(double t) const noexcept {
    if (!(t < duration())) return {rest(), 0, 0};
    std::size_t i = 0;
    for (; i < 2 && t >= times_[i]; ++i) t -= times_[i];
    return phases_[i].at(t);
  }

 private:
  static constexpr double kInfinite = 1e300;

  /// Constant jerk after `start`.
  struct Phase {
    Motion start;
    double jerk = 0;

    Motion at(double t) const noexcept {
      const double a = start.acceleration + jerk * t;
      return {start.position + t * (start.velocity + t * (start.acceleration / 2 + t * jerk / 6)),
              start.velocity + t * (start.acceleration + a) / 2, a};
    }
  };

  // Requires: signs of v and a such that the joint still moves forward after a has come to 0.
  void plan(double v, double a, const MotionLimits& limits) noexcept {
    const double j = limits.jerk;
    const double peak = math::sqrt(std::max(j * v + a * a / 2, 0.0));
    deceleration_ = std::max({std::min(peak, limits.acceleration), -a, 0.0});
    times_[0] = (a + deceleration_) / j;
    times_[2] = deceleration_ / j;
    const double more = v + (a * a - 2 * deceleration_ * deceleration_) / (2 * j);
    if (deceleration_ > 0) times_[1] = std::max(more / deceleration_, 0.0);
  }

  Phase phases_[3];
  double times_[3] = {};
  double deceleration_ = 0;
};

}  // namespace chimera::library
