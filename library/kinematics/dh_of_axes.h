// SPDX-License-Identifier: Apache-2.0
// Denavit-Hartenberg rows of a robot that is known by the axes of its joints: what a URDF or an MJCF file says.
#pragma once

#include <array>
#include <cmath>
#include <cstddef>
#include <span>

#include "library/kinematics/dh.h"

namespace chimera::library {

using Triple = std::array<double, 3>;

inline Triple operator+(const Triple& a, const Triple& b) noexcept { return {a[0] + b[0], a[1] + b[1], a[2] + b[2]}; }
inline Triple operator-(const Triple& a, const Triple& b) noexcept { return {a[0] - b[0], a[1] - b[1], a[2] - b[2]}; }
inline Triple operator*(double s, const Triple& a) noexcept { return {s * a[0], s * a[1], s * a[2]}; }
inline double dot(const Triple& a, const Triple& b) noexcept { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }
inline Triple cross(const Triple& a, const Triple& b) noexcept {
  return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}
inline double length(const Triple& a) noexcept { return std::sqrt(dot(a, a)); }

/// A place with axes: x, y and z are unit vectors, right-handed, in the frame that `origin` (m) is given in.
struct Frame {
  Triple origin{0, 0, 0}, x{1, 0, 0}, y{0, 1, 0}, z{0, 0, 1};

  /// `inner`, which is given in this frame, in the frame that this one is given in.
  Frame operator*(const Frame& inner) const noexcept {
    return {origin + turned(inner.origin), turned(inner.x), turned(inner.y), turned(inner.z)};
  }
  Triple turned(const Triple& v) const noexcept { return v[0] * x + v[1] * y + v[2] * z; }
  Triple seen(const Triple& v) const noexcept { return {dot(x, v), dot(y, v), dot(z, v)}; }
  /// `other`, which is given beside this one, as seen from this one.
  Frame seen(const Frame& other) const noexcept {
    return {seen(other.origin - origin), seen(other.x), seen(other.y), seen(other.z)};
  }
};

/// Rz(angle + theta) Tz(d) Tx(a) Rx(alpha).
inline Frame frame_of(const DhLink& link, double angle) noexcept {
  const double c = std::cos(angle + link.theta), s = std::sin(angle + link.theta);
  const double ca = std::cos(link.alpha), sa = std::sin(link.alpha);
  return {{link.a * c, link.a * s, link.d}, {c, s, 0}, {-s * ca, c * ca, sa}, {s * sa, -c * sa, ca}};
}

/// Orientation as a unit quaternion w x y z with w >= 0.
inline Pose pose_of(const Frame& f) noexcept {
  const double w = 1 + f.x[0] + f.y[1] + f.z[2], x = 1 + f.x[0] - f.y[1] - f.z[2];
  const double y = 1 - f.x[0] + f.y[1] - f.z[2], z = 1 - f.x[0] - f.y[1] + f.z[2];
  std::array<double, 4> q;  // the largest of four times the squares first: no cancellation
  if (w >= x && w >= y && w >= z) q = {w, f.y[2] - f.z[1], f.z[0] - f.x[2], f.x[1] - f.y[0]};
  else if (x >= y && x >= z) q = {f.y[2] - f.z[1], x, f.y[0] + f.x[1], f.z[0] + f.x[2]};
  else if (y >= z) q = {f.z[0] - f.x[2], f.y[0] + f.x[1], y, f.z[1] + f.y[2]};
  else q = {f.x[1] - f.y[0], f.z[0] + f.x[2], f.z[1] + f.y[2], z};
  const double norm = std::sqrt(q[0] * q[0] + q[1] * q[1] + q[2] * q[2] + q[3] * q[3]) * (q[0] < 0 ? -1 : 1);
  return {{f.origin[0], f.origin[1], f.origin[2]}, {q[0] / norm, q[1] / norm, q[2] / norm, q[3] / norm}};
}

/// The frame of a pose; its quaternion is taken as a unit one.
inline Frame frame_of(const Pose& pose) noexcept {
  const auto [w, x, y, z] = pose.orientation;
  return {{pose.position[0], pose.position[1], pose.position[2]},
          {1 - 2 * (y * y + z * z), 2 * (x * y + w * z), 2 * (x * z - w * y)},
          {2 * (x * y - w * z), 1 - 2 * (x * x + z * z), 2 * (y * z + w * x)},
          {2 * (x * z + w * y), 2 * (y * z - w * x), 1 - 2 * (x * x + y * y)}};
}

/// The axis of a joint: a point on it (m) and its direction, with the robot at zero, in the base frame.
struct JointAxis {
  Triple point, direction;
};

/// A robot in the constants of library/kinematics/dh.h.
struct DhChain {
  std::size_t ndof = 0;
  std::array<DhLink, kMostJoints> dh{};
  Pose base = kSamePlace, tool = kSamePlace;
};

/// Base to tool with the joints at `q` (rad, ndof of them). Context: cycle; wait-free.
inline Frame tool_frame(const DhChain& chain, std::span<const double> q) noexcept {
  Frame frame = frame_of(chain.base);
  for (std::size_t i = 0; i < chain.ndof; ++i) frame = frame * frame_of(chain.dh[i], q[i]);
  return frame * frame_of(chain.tool);
}

namespace dh_of_axes_steps {

// Directions closer than this are the same, lines closer than this (m) meet: what a file with six digits means.
inline constexpr double kSame = 1e-7;

inline Triple unit(const Triple& v) noexcept { return (1 / length(v)) * v; }

/// The angle from `a` to `b`, both at right angles to the unit vector `about`.
inline double angle(const Triple& a, const Triple& b, const Triple& about) noexcept {
  const double s = dot(cross(a, b), about), c = dot(a, b);
  return std::abs(s) < kSame * kSame ? (c < 0 ? std::atan2(0.0, -1.0) : 0) : std::atan2(s, c);
}

/// The base itself where the first axis is its z axis, else a frame on the first axis nearest to the base.
inline Frame first_frame(const JointAxis& axis) noexcept {
  const Triple z = unit(axis.direction), foot = axis.point - dot(axis.point, z) * z;
  const Triple across = std::abs(z[0]) < 0.9 ? Triple{1, 0, 0} : Triple{0, 1, 0};
  const Triple x = unit(across - dot(across, z) * z);
  return {foot, x, cross(z, x), z};
}

/// From the frame on one axis to the frame on the next, at zero.
inline Frame next_frame(const Frame& from, const JointAxis& axis) noexcept {
  const Triple z = unit(axis.direction), between = axis.point - from.origin, normal = cross(from.z, z);
  const double sine = length(normal);
  Triple origin, x;
  if (sine < kSame) {  // parallel: the common normal through the present origin
    const Triple across = between - dot(between, from.z) * from.z;
    origin = from.origin + across;
    x = length(across) < kSame ? from.x : unit(across);
  } else {
    const double cosine = dot(from.z, z);
    const double along_next = (cosine * dot(between, from.z) - dot(between, z)) / (sine * sine);
    origin = axis.point + along_next * z;
    const double along_this = dot(between + along_next * z, from.z);
    const Triple across = origin - from.origin - along_this * from.z;
    x = length(across) < kSame ? unit(normal) : unit(across);
    if (length(across) < kSame && dot(x, from.x) < 0) x = -1.0 * x;
  }
  return {origin, x, cross(z, x), z};
}

/// The row that leads from one frame to another whose x axis meets the first z axis at a right angle.
inline DhLink row(const Frame& from, const Frame& to) noexcept {
  const Triple between = to.origin - from.origin;
  return {dot(between, to.x), angle(from.z, to.z, to.x), dot(between, from.z), angle(from.x, to.x, from.z)};
}

}  // namespace dh_of_axes_steps

/// The constants of a robot with these axes whose tool frame at zero is `tool`. As many axes as 1 to kMostJoints;
/// directions need not have length 1 but not 0. Context: setup.
inline DhChain dh_of_axes(std::span<const JointAxis> axes, const Frame& tool) noexcept {
  using namespace dh_of_axes_steps;
  DhChain chain;
  chain.ndof = axes.size();
  Frame frame = first_frame(axes[0]);
  chain.base = pose_of(frame);
  for (std::size_t i = 1; i < axes.size(); ++i) {
    const Frame next = next_frame(frame, axes[i]);
    chain.dh[i - 1] = row(frame, next);
    frame = next;
  }
  // The last row takes the tool as far as one row can.
  const Frame seen = frame.seen(tool);
  const double beside = seen.origin[0] * seen.x[1] - seen.origin[1] * seen.x[0];
  if (std::abs(seen.x[2]) < kSame && std::abs(beside) < kSame) chain.dh[axes.size() - 1] = row(frame, tool);
  else chain.tool = pose_of(seen);
  return chain;
}

}  // namespace chimera::library
