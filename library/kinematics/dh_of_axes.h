// SPDX-License-Identifier: Apache-2.0
// Denavit-Hartenberg rows from the axes of the joints, which a URDF or an MJCF file gives.
#pragma once

#include <array>
#include <cmath>
#include <cstddef>
#include <span>

#include "library/kinematics/dh.h"
#include "library/kinematics/frame.h"

namespace chimera::library {

/// Rz(angle + theta) Tz(d) Tx(a) Rx(alpha).
inline Frame frame_of(const DhLink& link, double angle) noexcept {
  const double c = std::cos(angle + link.theta), s = std::sin(angle + link.theta);
  const double ca = std::cos(link.alpha), sa = std::sin(link.alpha);
  return {{link.a * c, link.a * s, link.d}, {c, s, 0}, {-s * ca, c * ca, sa}, {s * sa, -c * sa, ca}};
}

/// Axis of a joint in the base frame, with the robot at zero: a point on it (m) and its direction.
struct JointAxis {
  Vec3 point, direction;
};

/// A robot in the constants of library/kinematics/dh.h.
struct DhChain {
  std::size_t ndof = 0;
  std::array<DhLink, kMostJoints> dh{};
  Pose base = kIdentityPose, tool = kIdentityPose;
};

/// Base to tool with the joints at `q` (rad, ndof of them). Context: cycle; wait-free.
inline Frame tool_frame(const DhChain& chain, std::span<const double> q) noexcept {
  Frame frame = frame_of(chain.base);
  for (std::size_t i = 0; i < chain.ndof; ++i) frame = frame * frame_of(chain.dh[i], q[i]);
  return frame * frame_of(chain.tool);
}

namespace dh_of_axes_steps {

// Directions closer than this count as parallel, lines closer than this (m) as meeting: the accuracy of a file with six
// digits.
inline constexpr double kSame = 1e-7;

inline Vec3 unit(const Vec3& v) noexcept { return (1 / length(v)) * v; }

/// Angle from `a` to `b`. Both are perpendicular to the unit vector `about`.
inline double angle(const Vec3& a, const Vec3& b, const Vec3& about) noexcept {
  const double s = dot(cross(a, b), about), c = dot(a, b);
  return std::abs(s) < kSame * kSame ? (c < 0 ? std::atan2(0.0, -1.0) : 0) : std::atan2(s, c);
}

/// The base if its z axis is the first axis; otherwise the frame on the first axis that is nearest to the base.
inline Frame first_frame(const JointAxis& axis) noexcept {
  const Vec3 z = unit(axis.direction), foot = axis.point - dot(axis.point, z) * z;
  const Vec3 across = std::abs(z[0]) < 0.9 ? Vec3{1, 0, 0} : Vec3{0, 1, 0};
  const Vec3 x = unit(across - dot(across, z) * z);
  return {foot, x, cross(z, x), z};
}

/// Frame on the next axis, from the frame on the present one, at zero.
inline Frame next_frame(const Frame& from, const JointAxis& axis) noexcept {
  const Vec3 z = unit(axis.direction), between = axis.point - from.origin, normal = cross(from.z, z);
  const double sine = length(normal);
  Vec3 origin, x;
  if (sine < kSame) {  // parallel: the common normal through the present origin
    const Vec3 across = between - dot(between, from.z) * from.z;
    origin = from.origin + across;
    x = length(across) < kSame ? from.x : unit(across);
  } else {
    const double cosine = dot(from.z, z);
    const double along_next = (cosine * dot(between, from.z) - dot(between, z)) / (sine * sine);
    origin = axis.point + along_next * z;
    const double along_this = dot(between + along_next * z, from.z);
    const Vec3 across = origin - from.origin - along_this * from.z;
    x = length(across) < kSame ? unit(normal) : unit(across);
    if (length(across) < kSame && dot(x, from.x) < 0) x = -1.0 * x;
  }
  return {origin, x, cross(z, x), z};
}

/// The row from one frame to another. The x axis of `to` must meet the z axis of `from` at a right angle.
inline DhLink row(const Frame& from, const Frame& to) noexcept {
  const Vec3 between = to.origin - from.origin;
  return {dot(between, to.x), angle(from.z, to.z, to.x), dot(between, from.z), angle(from.x, to.x, from.z)};
}

}  // namespace dh_of_axes_steps

/// Constants of a robot with these axes and with the tool frame `tool` at zero. There are 1 to kMostJoints axes. A
/// direction need not have length 1, but must not be 0. Context: setup.
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
  // The last row comes as near to the tool as a row can.
  const Frame seen = frame.relative(tool);
  const double beside = seen.origin[0] * seen.x[1] - seen.origin[1] * seen.x[0];
  if (std::abs(seen.x[2]) < kSame && std::abs(beside) < kSame) chain.dh[axes.size() - 1] = row(frame, tool);
  else chain.tool = pose_of(seen);
  return chain;
}

}  // namespace chimera::library
