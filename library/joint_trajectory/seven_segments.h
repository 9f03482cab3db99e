// SPDX-License-Identifier: Apache-2.0
// From rest to rest in the least time within limits of velocity, acceleration and jerk: at most seven segments of
// constant jerk. Without a limit of jerk the velocity is a trapezoid (Biagiotti and Melchiorri, Trajectory Planning for
// Automatic Machines and Robots, 2008, sections 3.2 and 3.4).
#pragma once

#include "chimera/base/math.h"
#include "library/joint_trajectory/quintic.h"

namespace chimera::library {

/// Limits of one joint, in U/s, U/s2, U/s3, all above 0; an infinite jerk gives the trapezoid.
struct MotionLimits {
  double velocity = 1;
  double acceleration = 1;
  double jerk = 1;
};

/// One joint from rest to rest. Context: cycle; wait-free.
class SevenSegments {
 public:
  SevenSegments() noexcept = default;
  SevenSegments(double from, double to, const MotionLimits& limits) noexcept : from_(from), to_(to) {
    const double way = math::fabs(to - from);
    if (!(way > 0)) return;
    plan(way, limits);
    // Computes the peaks from the way again, so that rounding of the times does not change the way.
    const double velocity = way / (ramp_ + cruise_);
    peak_acceleration_ = math::copysign(velocity / (ramp_ - jerk_time_), to - from);
  }

  /// Least time from rest to rest (s); 0 for no way.
  double least_duration() const noexcept { return 2 * ramp_ + cruise_; }
  /// Takes `duration` if that is longer than the least time. Time then runs slower: velocity, acceleration and jerk
  /// fall with its first, second and third power.
  void stretch(double duration) noexcept {
    if (duration > least_duration() && least_duration() > 0) slower_ = duration / least_duration();
  }
  double duration() const noexcept { return least_duration() * slower_; }

  /// Motion at time t (s): at rest in `from` before 0, at rest exactly in `to` after the duration.
  Motion at(double t) const noexcept {
    if (t >= duration()) return {to_, 0, 0};
    if (!(t > 0)) return {from_, 0, 0};
    const double own = t / slower_, left = least_duration() - own;
    Motion motion;
    if (own <= ramp_) {
      motion = ramp(own);
      motion.position += from_;
    } else if (left > ramp_) {
      const double velocity = peak_acceleration_ * (ramp_ - jerk_time_);
      motion = {from_ + velocity * (ramp_ / 2 + (own - ramp_)), velocity, 0};
    } else {  // mirror image of the acceleration
      motion = ramp(left);
      motion = {to_ - motion.position, motion.velocity, -motion.acceleration};
    }
    return {motion.position, motion.velocity / slower_, motion.acceleration / (slower_ * slower_)};
  }

 private:
  void plan(double way, const MotionLimits& limits) noexcept {
    const double v = limits.velocity, a = limits.acceleration, j = limits.jerk;
    jerk_time_ = a / j;
    ramp_ = jerk_time_ + v / a;
    if (v / a < jerk_time_) {  // acceleration limit not reached
      jerk_time_ = math::sqrt(v / j);
      ramp_ = 2 * jerk_time_;
    }
    cruise_ = way / v - ramp_;
    if (cruise_ >= 0) return;
    cruise_ = 0;  // velocity limit not reached
    jerk_time_ = a / j;
    ramp_ = jerk_time_ / 2 + math::sqrt(jerk_time_ * jerk_time_ / 4 + way / a);
    if (ramp_ >= 2 * jerk_time_) return;
    jerk_time_ = cube_root(way / (2 * j));
    ramp_ = 2 * jerk_time_;
  }
  static double cube_root(double x) noexcept { return math::exp(math::log(x) / 3); }

  // Accelerating part at t <= ramp_, from rest at 0.
  Motion ramp(double t) const noexcept {
    const double a = peak_acceleration_, tj = jerk_time_;
    if (t < tj) {
      const double j = a / tj;
      return {j * t * t * t / 6, j * t * t / 2, j * t};
    }
    const double left = ramp_ - t;
    const double velocity = a * (ramp_ - tj);
    if (left >= tj) {
      const double since = t - tj;
      return {a * tj * tj / 6 + a * tj / 2 * since + a * since * since / 2, a * tj / 2 + a * since, a};
    }
    const double j = a / tj;
    return {velocity * (ramp_ / 2 - left) + j * left * left * left / 6, velocity - j * left * left / 2, j * left};
  }

  double from_ = 0, to_ = 0;
  double jerk_time_ = 0;  // s, constant jerk
  double ramp_ = 0;       // s, from rest to the cruising velocity
  double cruise_ = 0;     // s
  double peak_acceleration_ = 0;
  double slower_ = 1;
};

}  // namespace chimera::library
