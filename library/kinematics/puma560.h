// SPDX-License-Identifier: Apache-2.0
// The Puma 560 in closed form: standard Denavit-Hartenberg angles, base at the shoulder, tool at the flange.
// With c23 = cos(q2 + q3), the wrist centre in the plane of the arm is
//   x' = a2 c2 + a3 c23 - d4 s23,   y' = a2 s2 + a3 s23 + d4 c23,   z' = d3,
// and the wrist is Rz(q4) Ry(-q5) Rz(q6).
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <span>

#include "library/kinematics/serial_arm.h"

namespace chimera::library {

/// Constants, limits, forward and inverse kinematics.
struct Puma560 {
  static constexpr std::size_t kJoints = 6;
  static constexpr double kPi = std::numbers::pi;
  static constexpr double a2 = .4318, a3 = .0203, d3 = .15005, d4 = .4318, d6 = .05625;  ///< m
  using Vector = std::array<double, kJoints>;                                              ///< rad

  static constexpr std::array<DhLink, kJoints> kRows{
      DhLink{0, kPi / 2, 0, 0}, {a2, 0, 0, 0},       {a3, -kPi / 2, d3, 0},
      {0, kPi / 2, d4, 0},      {0, -kPi / 2, 0, 0}, {0, 0, d6, 0}};
  static constexpr double kDegree = kPi / 180;
  static constexpr Vector kLow{-160 * kDegree, -45 * kDegree, -225 * kDegree, -110 * kDegree, -100 * kDegree,
                               -266 * kDegree};
  static constexpr Vector kHigh{160 * kDegree, 225 * kDegree, 45 * kDegree, 170 * kDegree, 100 * kDegree,
                                266 * kDegree};

  /// Base to flange. Context: cycle; wait-free.
  static Frame forward(std::span<const double, kJoints> q) noexcept {
    Jacobian unused;
    return forward(q, unused);
  }
  /// Base to flange, and the Jacobian at `q`.
  static Frame forward(std::span<const double, kJoints> q, Jacobian& jacobian) noexcept {
    const double c1 = std::cos(q[0]), s1 = std::sin(q[0]), c2 = std::cos(q[1]), s2 = std::sin(q[1]);
    const double c23 = std::cos(q[1] + q[2]), s23 = std::sin(q[1] + q[2]);
    const double c4 = std::cos(q[3]), s4 = std::sin(q[3]), c5 = std::cos(q[4]), s5 = std::sin(q[4]);
    const double c6 = std::cos(q[5]), s6 = std::sin(q[5]);
    const Frame forearm = forearm_frame(c1, s1, c23, s23);
    Frame f;
    f.x = forearm.rotate({c4 * c5 * c6 - s4 * s6, s4 * c5 * c6 + c4 * s6, s5 * c6});
    f.y = forearm.rotate({-c4 * c5 * s6 - s4 * c6, -s4 * c5 * s6 + c4 * c6, -s5 * s6});
    f.z = forearm.rotate({-c4 * s5, -s4 * s5, c5});
    const double out = a2 * c2 + a3 * c23 - d4 * s23, up = a2 * s2 + a3 * s23 + d4 * c23;
    const Vec3 aside{s1, -c1, 0}, wrist{c1 * out + s1 * d3, s1 * out - c1 * d3, up}, flange = d6 * f.z;
    const Vec3 elbow{a2 * c2 * c1, a2 * c2 * s1, a2 * s2};
    f.origin = wrist + flange;
    jacobian.angular = {Vec3{0, 0, 1}, aside, aside, forearm.z, forearm.rotate({s4, -c4, 0}), f.z};
    jacobian.linear = {Vec3{-f.origin[1], f.origin[0], 0}, cross(aside, f.origin), cross(aside, f.origin - elbow)};
    for (std::size_t i : {3, 4}) jacobian.linear[i] = cross(jacobian.angular[i], flange);
    return f;
  }

  /// All joint positions that bring the flange to `wanted`, up to eight: arm left or right, elbow up or down, wrist
  /// turned or not. At a singular pose pairs of solutions coincide. If the wrist is stretched or folded back (q5 = 0 or
  /// pi), only the sum or difference of q4 and q6 is determined; q4 is then that of `near`, within its limits.
  struct Solutions {
    std::array<Vector, 8> q{};
    std::size_t count = 0;
  };
  static Solutions inverse(const Frame& wanted, std::span<const double, kJoints> near) noexcept {
    Solutions found;
    const Vec3 p = wanted.origin - d6 * wanted.z;
    const double r = std::hypot(p[0], p[1]);
    if (!(r >= d3 - kRounding)) return found;
    const double toward = std::atan2(p[1], p[0]), aside = std::asin(std::min(1.0, d3 / r));
    for (const double q1 : {toward + aside, toward + kPi - aside}) {
      const double out = std::cos(q1) * p[0] + std::sin(q1) * p[1];
      add_elbows(wanted, near, q1, out, p[2], found);
    }
    return found;
  }

  /// Finds the solution within the joint limits that is nearest to `near`, by the joint that moves most. Angles are
  /// turned towards `near` by whole turns. Returns false and writes nothing if there is none. Context: cycle;
  /// wait-free.
  static bool nearest(const Frame& wanted, std::span<const double, kJoints> near,
                      std::span<double, kJoints> q) noexcept {
    Solutions all = inverse(wanted, near);
    double best = std::numeric_limits<double>::infinity();
    const Vector from{near[0], near[1], near[2], near[3], near[4], near[5]};
    for (std::size_t s = 0; s < all.count; ++s) {
      const double distance = settle(all.q[s], from);
      if (!(distance < best)) continue;
      best = distance;
      std::copy(all.q[s].begin(), all.q[s].end(), q.begin());
    }
    return std::isfinite(best);
  }

 private:
  static constexpr double kRounding = 1e-12;   // keeps a stretched arm within reach
  // Rounding error of a q5 of 0 (rad). It is larger if the elbow is nearly stretched, too, because its angle is then
  // uncertain.
  static constexpr double kStretched = 4e-10, kDoublyStretched = 1e-7;

  /// Frame 3, in whose axes the wrist turns.
  static Frame forearm_frame(double c1, double s1, double c23, double s23) noexcept {
    return {{0, 0, 0}, {c1 * c23, s1 * c23, s23}, {-s1, c1, 0}, {-c1 * s23, -s1 * s23, c23}};
  }
  static void add_elbows(const Frame& wanted, std::span<const double, kJoints> near, double q1, double out, double up,
                         Solutions& found) noexcept {
    const double reach = std::hypot(a3, d4), bend = std::atan2(d4, a3);
    const double cosine = (out * out + up * up - a2 * a2 - reach * reach) / (2 * a2 * reach);
    if (!(std::abs(cosine) <= 1 + kRounding)) return;
    for (const double sign : {1.0, -1.0}) {
      const double q3 = sign * std::acos(std::clamp(cosine, -1.0, 1.0)) - bend;
      const double along = a2 + a3 * std::cos(q3) - d4 * std::sin(q3), across = a3 * std::sin(q3) + d4 * std::cos(q3);
      const double q2 = std::atan2(up, out) - std::atan2(across, along);
      const double elbow = std::sqrt(std::max(0.0, 1 - cosine * cosine));
      const double stretched = std::clamp(kRounding / (100 * elbow), kStretched, kDoublyStretched);
      add_wrists(wanted, near, {q1, q2, q3}, stretched, found);
    }
  }
  static void add_wrists(const Frame& wanted, std::span<const double, kJoints> near, const Vec3& arm, double stretched,
                         Solutions& found) noexcept {
    const Frame forearm = forearm_frame(std::cos(arm[0]), std::sin(arm[0]), std::cos(arm[1] + arm[2]),
                                        std::sin(arm[1] + arm[2]));
    const Vec3 x = forearm.inverse_rotate(wanted.x), y = forearm.inverse_rotate(wanted.y),
               z = forearm.inverse_rotate(wanted.z);
    const double s5 = std::hypot(z[0], z[1]);
    for (const double sign : {1.0, -1.0}) {
      const bool is_told = s5 > stretched;
      const double q4 = is_told ? std::atan2(-sign * z[1], -sign * z[0]) : std::clamp(near[3], kLow[3], kHigh[3]);
      const double c4 = std::cos(q4), s4 = std::sin(q4);
      // Remainder of x and y across the axis of joint 5. It is right for any rounding of q4.
      const double q6 = std::atan2(c4 * x[1] - s4 * x[0], c4 * y[1] - s4 * y[0]);
      found.q[found.count++] = {arm[0], arm[1], arm[2], q4, std::atan2(sign * s5, z[2]), q6};
    }
  }
  /// Turns each angle by whole turns to the nearest value within its limits. Returns the distance of the farthest
  /// joint, or infinity if a joint cannot be within its limits.
  static double settle(Vector& q, const Vector& near) noexcept {
    double farthest = 0;
    for (std::size_t i = 0; i < kJoints; ++i) {
      double best = std::numeric_limits<double>::infinity(), angle = q[i];
      const double first = q[i] + 2 * kPi * std::round((near[i] - q[i]) / (2 * kPi));
      for (const double turned : {first, first - 2 * kPi, first + 2 * kPi}) {
        const bool within = turned >= kLow[i] - 1e-9 && turned <= kHigh[i] + 1e-9;
        if (!within || std::abs(turned - near[i]) >= best) continue;
        best = std::abs(turned - near[i]);
        angle = turned;
      }
      q[i] = angle;
      farthest = std::max(farthest, best);
    }
    return farthest;
  }
};

}  // namespace chimera::library
