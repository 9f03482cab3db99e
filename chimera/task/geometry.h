// SPDX-License-Identifier: Apache-2.0
// Structs for ports that describe bodies in space, each with a unit per field. The port names the reference frame:
// `frame = "base"`.
#pragma once

#include <tuple>

#include "chimera/task/fields.h"

namespace chimera {

/// The place of a body: position in m; orientation as a unit quaternion, scalar first (w x y z), body to frame.
struct Pose {
  double position[3];
  double orientation[4];
};

/// The motion of a body: velocity of its origin in m/s, angular velocity in rad/s, both along the axes of the frame.
struct Twist {
  double linear[3];
  double angular[3];
};

/// The load on a body: force in N at its origin, torque in N.m, both along the axes of the frame.
struct Wrench {
  double force[3];
  double torque[3];
};

template <>
struct Fields<Pose> {
  static constexpr const char* name = "Pose";
  static constexpr auto list =
      std::tuple{field("position", "m", &Pose::position), field("orientation", "1", &Pose::orientation)};
};

template <>
struct Fields<Twist> {
  static constexpr const char* name = "Twist";
  static constexpr auto list =
      std::tuple{field("linear", "m/s", &Twist::linear), field("angular", "rad/s", &Twist::angular)};
};

template <>
struct Fields<Wrench> {
  static constexpr const char* name = "Wrench";
  static constexpr auto list =
      std::tuple{field("force", "N", &Wrench::force), field("torque", "N.m", &Wrench::torque)};
};

}  // namespace chimera
