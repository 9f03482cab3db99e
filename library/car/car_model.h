// SPDX-License-Identifier: Apache-2.0
// A car on a straight road (Astrom and Murray, Feedback Systems, 2008, chapter 3, "Cruise control"; its numbers).
#pragma once

#include <algorithm>
#include <cmath>

#include "chimera/base/math.h"

namespace chimera::library {

/// Properties of a car. The defaults are those of the book; lag and wheel radius are ours.
struct CarBody {
  double mass = 1600;            ///< kg
  double drag_area = 0.32 * 2.4; ///< Cd A, m2
  double rolling = 0.01;         ///< rolling resistance by weight
  double air_density = 1.3;      ///< kg/m3
  double wheel_radius = 0.3;     ///< m
};

/// The combustion engine in one gear: torque T(w) = Tm (1 - beta (w/wm - 1)^2), w = gear v, force gear T.
struct CarEngine {
  double peak_torque = 190;  ///< Tm, N.m
  double peak_speed = 420;   ///< wm, rad/s
  double shape = 0.4;        ///< beta
  double gear = 12;          ///< engine radians for each metre, fourth gear
  double lag = 0.2;          ///< s, from the pedal to the torque

  /// Force at the wheels with the throttle open by `gas` (0 to 1) at `speed` (m/s). Context: cycle; wait-free.
  double force(double gas, double speed) const noexcept {
    const double off_peak = gear * speed / peak_speed - 1;
    return gear * std::clamp(gas, 0.0, 1.0) * peak_torque * std::max(0.0, 1 - shape * off_peak * off_peak);
  }
};

/// The car's motion along the road. Positive is forward.
class CarModel {
 public:
  explicit CarModel(const CarBody& body = {}) noexcept : body_(body) {}

  void place(double speed) noexcept {
    speed_ = speed;
    distance_ = 0;
    wheel_angle_ = 0;
  }
  /// Continues at the speed of another car, with the distance of a wheel angle of `wheel_angle` (rad).
  void resume(double speed, double wheel_angle) noexcept {
    speed_ = speed;
    wheel_angle_ = wheel_angle;
    distance_ = wheel_angle * body_.wheel_radius;
  }
  /// Changes load or wheels and keeps place and speed.
  void refit(const CarBody& body) noexcept { body_ = body; }

  /// Advances by `dt` (s) under `drive` and `brake` (N, brake >= 0) on a `grade` (rise over run). Brakes and rolling
  /// resistance can stop the car but not push it. Requires: dt >= 0. Context: cycle; wait-free.
  void step(double drive, double brake, double grade, double dt) noexcept {
    constexpr double kGravity = 9.81;
    const double level = 1 / math::sqrt(1 + grade * grade);  // cos s, with tan s = grade
    const double air = 0.5 * body_.air_density * body_.drag_area * speed_ * std::abs(speed_);
    const double pushed = speed_ + (drive - air - body_.mass * kGravity * grade * level) / body_.mass * dt;
    const double rubbed = (brake + body_.rolling * body_.mass * kGravity * level) / body_.mass * dt;
    const double before = speed_;
    speed_ = std::abs(pushed) <= rubbed ? 0 : pushed - math::copysign(rubbed, pushed);
    const double moved = 0.5 * (before + speed_) * dt;
    distance_ += moved;
    wheel_angle_ += moved / body_.wheel_radius;
  }

  double speed() const noexcept { return speed_; }        ///< m/s
  double distance() const noexcept { return distance_; }  ///< m since place()
  double wheel_angle() const noexcept { return wheel_angle_; }  ///< rad since place()

 private:
  CarBody body_;
  double speed_ = 0;
  double distance_ = 0;
  double wheel_angle_ = 0;
};

}  // namespace chimera::library
