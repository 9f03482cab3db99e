// SPDX-License-Identifier: Apache-2.0
// For tests: random arms and poses, and the distance between two results.
#pragma once

#include <algorithm>
#include <numbers>
#include <random>

#include "library/kinematics/testing/kdl_oracle.h"
#include "library/kinematics/serial_arm.h"

namespace chimera::library {

using Joints = std::array<double, kMostJoints>;

struct RandomArms {
  std::mt19937 random{2026};
  double within(double least, double most) { return std::uniform_real_distribution<double>(least, most)(random); }
  double metre() { return within(-0.5, 0.5); }
  double rad() { return within(-std::numbers::pi, std::numbers::pi); }
  double right_angle() { return std::uniform_int_distribution<int>(-2, 2)(random) * std::numbers::pi / 2; }

  Pose place() {
    Pose made{{metre(), metre(), metre()}, {within(-1, 1), within(-1, 1), within(-1, 1), within(0.1, 1)}};
    double square = 0;
    for (double part : made.orientation) square += part * part;
    for (double& part : made.orientation) part /= std::sqrt(square);
    return made;
  }
  /// A plain arm has right angles and lengths of 0, as real arms have.
  DhChain chain(std::size_t joints, bool is_plain) {
    DhChain made;
    made.ndof = joints;
    for (std::size_t i = 0; i < joints; ++i) {
      made.dh[i] = {is_plain && i % 3 == 0 ? 0 : metre(), is_plain ? right_angle() : rad(),
                    is_plain && i % 2 == 0 ? 0 : metre(), is_plain ? right_angle() : rad()};
    }
    if (is_plain) return made;
    made.base = place();
    made.tool = place();
    return made;
  }
  /// Each tenth pose has right angles and the next nearly so: plain arms are singular there, and near it.
  Joints joints(std::size_t pose) {
    Joints q;
    for (double& angle : q) angle = pose % 10 > 1 ? rad() : right_angle() + (pose % 10 == 1 ? within(-1e-6, 1e-6) : 0);
    return q;
  }
};

inline double difference(const Vec3& a, const Vec3& b) { return length(a - b); }
inline double difference(const Frame& a, const Frame& b) {
  return std::max({difference(a.origin, b.origin), difference(a.x, b.x), difference(a.y, b.y), difference(a.z, b.z)});
}
inline double difference(const Jacobian& a, const Jacobian& b, std::size_t ndof) {
  double farthest = 0;
  for (std::size_t i = 0; i < ndof; ++i) {
    farthest = std::max({farthest, difference(a.linear[i], b.linear[i]), difference(a.angular[i], b.angular[i])});
  }
  return farthest;
}

}  // namespace chimera::library
