// SPDX-License-Identifier: Apache-2.0
// In-consts from which generic kinematics reads the geometry of the robot.
#pragma once

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <string>

#include "chimera/task/component.h"
#include "library/kinematics/serial_arm.h"

namespace chimera::library {

/// Base of a component with these ports. The component calls read_chain() in init and reinit.
struct DhPorts {
  InConst<std::int32_t> ndof{"ndof", "1", range(1, 10), doc = "Joints."};
  InConst<DhLink[]> dh{"dh", "1", "[ndof<=10]", doc = "Denavit-Hartenberg rows, base to tip."};
  InConst<Pose> base{"base", initial = kIdentityPose, frame = "base", doc = "Frame 0."};
  InConst<Pose> tool{"tool", initial = kIdentityPose, frame = "last", doc = "Tool frame in frame ndof."};

 protected:
  SerialArm arm_;

  /// Throws for constants that describe no arm. Context: setup.
  DhChain read_chain() {
    DhChain chain;
    chain.ndof = dh.size();
    for (std::size_t i = 0; i < dh.size(); ++i) {
      const DhLink& link = dh[i];
      const double sum = link.a + link.alpha + link.d + link.theta;
      if (!std::isfinite(sum)) throw std::runtime_error("dh: a number is not finite");
      chain.dh[i] = link;
    }
    chain.base = sound(*base, "base");
    chain.tool = sound(*tool, "tool");
    arm_ = SerialArm(chain);
    return chain;
  }

 public:
  /// Returns true if all numbers are finite and the orientation is a unit quaternion within 1e-3, which allows for
  /// rounding and slow integration. Context: cycle; wait-free.
  static bool is_pose(const Pose& pose) noexcept {
    double sum = 0, square = 0;
    for (double x : pose.position) sum += x;
    for (double x : pose.orientation) square += x * x;
    return std::isfinite(sum) && std::abs(square - 1) < 1e-3;
  }

 private:
  static Pose sound(const Pose& pose, const char* name) {
    if (is_pose(pose)) return pose;
    throw std::runtime_error(std::string(name) + ": not finite, or the orientation is no unit quaternion");
  }
};

}  // namespace chimera::library
