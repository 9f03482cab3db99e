// SPDX-License-Identifier: Apache-2.0
// Vectors and homogeneous transforms for kinematics and cameras.
#pragma once

#include <array>
#include <cmath>
#include <cstddef>

#include "chimera/task/geometry.h"

namespace chimera::library {

/// Three numbers: a point (m) or a direction.
struct Vec3 {
  double at[3];

  double& operator[](std::size_t i) noexcept { return at[i]; }
  const double& operator[](std::size_t i) const noexcept { return at[i]; }
};

inline Vec3 operator+(const Vec3& a, const Vec3& b) noexcept { return {a[0] + b[0], a[1] + b[1], a[2] + b[2]}; }
inline Vec3 operator-(const Vec3& a, const Vec3& b) noexcept { return {a[0] - b[0], a[1] - b[1], a[2] - b[2]}; }
inline Vec3 operator*(double s, const Vec3& a) noexcept { return {s * a[0], s * a[1], s * a[2]}; }
inline double dot(const Vec3& a, const Vec3& b) noexcept { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }
inline Vec3 cross(const Vec3& a, const Vec3& b) noexcept {
  return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}
inline double length(const Vec3& a) noexcept { return std::sqrt(dot(a, a)); }

/// A homogeneous transform. x, y, z (right-handed unit vectors) and `origin` (m) are in the parent frame.
struct Frame {
  Vec3 origin{0, 0, 0}, x{1, 0, 0}, y{0, 1, 0}, z{0, 0, 1};

  /// Expresses `inner`, a frame in this frame, in the parent frame.
  Frame operator*(const Frame& inner) const noexcept {
    return {origin + rotate(inner.origin), rotate(inner.x), rotate(inner.y), rotate(inner.z)};
  }
  /// R v: expresses a direction of this frame in the parent frame.
  Vec3 rotate(const Vec3& v) const noexcept { return v[0] * x + v[1] * y + v[2] * z; }
  /// R^T v: expresses a direction of the parent frame in this frame.
  Vec3 inverse_rotate(const Vec3& v) const noexcept { return {dot(x, v), dot(y, v), dot(z, v)}; }
  /// Expresses `other`, a frame in the parent frame, in this frame.
  Frame relative(const Frame& other) const noexcept {
    return {inverse_rotate(other.origin - origin), inverse_rotate(other.x), inverse_rotate(other.y),
            inverse_rotate(other.z)};
  }
};

/// Orientation as a unit quaternion w x y z with w >= 0.
inline Pose pose_of(const Frame& f) noexcept {
  const double w = 1 + f.x[0] + f.y[1] + f.z[2], x = 1 + f.x[0] - f.y[1] - f.z[2];
  const double y = 1 - f.x[0] + f.y[1] - f.z[2], z = 1 - f.x[0] - f.y[1] + f.z[2];
  std::array<double, 4> q;  // computed from the largest of the four squares, which avoids cancellation
  if (w >= x && w >= y && w >= z) q = {w, f.y[2] - f.z[1], f.z[0] - f.x[2], f.x[1] - f.y[0]};
  else if (x >= y && x >= z) q = {f.y[2] - f.z[1], x, f.y[0] + f.x[1], f.z[0] + f.x[2]};
  else if (y >= z) q = {f.z[0] - f.x[2], f.y[0] + f.x[1], y, f.z[1] + f.y[2]};
  else q = {f.x[1] - f.y[0], f.z[0] + f.x[2], f.z[1] + f.y[2], z};
  const double norm = std::sqrt(q[0] * q[0] + q[1] * q[1] + q[2] * q[2] + q[3] * q[3]) * (q[0] < 0 ? -1 : 1);
  return {{f.origin[0], f.origin[1], f.origin[2]}, {q[0] / norm, q[1] / norm, q[2] / norm, q[3] / norm}};
}

/// Frame of a pose. The quaternion must be a unit one.
inline Frame frame_of(const Pose& pose) noexcept {
  const auto [w, x, y, z] = pose.orientation;
  return {{pose.position[0], pose.position[1], pose.position[2]},
          {1 - 2 * (y * y + z * z), 2 * (x * y + w * z), 2 * (x * z - w * y)},
          {2 * (x * y - w * z), 1 - 2 * (x * x + z * z), 2 * (y * z + w * x)},
          {2 * (x * z + w * y), 2 * (y * z - w * x), 1 - 2 * (x * x + y * y)}};
}

/// Angle of the turn between two orientations (rad, 0 to pi). Both are unit quaternions.
inline double angle_between(const double (&a)[4], const double (&b)[4]) noexcept {
  const double c = std::abs(a[0] * b[0] + a[1] * b[1] + a[2] * b[2] + a[3] * b[3]);
  double square = 0;  // of the shorter of a - b and a + b: exact for small angles, where c is not
  const double sign = a[0] * b[0] + a[1] * b[1] + a[2] * b[2] + a[3] * b[3] < 0 ? -1 : 1;
  for (std::size_t i = 0; i < 4; ++i) square += (a[i] - sign * b[i]) * (a[i] - sign * b[i]);
  return 2 * std::atan2(std::sqrt(square * (1 - square / 4)), c);
}

/// Turns `orientation` by at most `angle` rad towards `goal`, the short way.
inline void turn_towards(double (&orientation)[4], const double (&goal)[4], double angle) noexcept {
  const double whole = angle_between(orientation, goal);
  const double share = whole <= angle ? 1 : angle / whole;
  const double sign = orientation[0] * goal[0] + orientation[1] * goal[1] + orientation[2] * goal[2] +
                                  orientation[3] * goal[3] < 0 ? -1 : 1;
  const double half = whole / 2, s = std::sin(half);
  const double from = s < 1e-6 ? 1 - share : std::sin((1 - share) * half) / s;
  const double to = sign * (s < 1e-6 ? share : std::sin(share * half) / s);
  double square = 0;
  for (std::size_t i = 0; i < 4; ++i) {
    orientation[i] = from * orientation[i] + to * goal[i];
    square += orientation[i] * orientation[i];
  }
  for (double& q : orientation) q /= std::sqrt(square);
}

}  // namespace chimera::library
