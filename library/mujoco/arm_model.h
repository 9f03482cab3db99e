// SPDX-License-Identifier: Apache-2.0
// Which joints of a MuJoCo model are the arm, and what its file says of them.
#pragma once

#include <array>
#include <cstddef>

#include "chimera/base/result.h"
#include "library/kinematics/dh_of_axes.h"

struct mjModel_;
struct mjData_;

namespace chimera::library {

using ArmVector = std::array<double, kMostJoints>;  ///< one number a joint, base to tip; the rest is 0

inline constexpr double kNoTorqueLimit = 1e6;  ///< N.m: the file states none
inline constexpr double kNoJointLimit = 1e6;   ///< rad: the file states none

/// The hinges from the world to the tip. Whatever else moves in the model is scenery: it has its physics and no drive.
struct ArmModel {
  std::size_t ndof = 0;
  std::array<int, kMostJoints> dof{};       ///< where the joint's velocity and force stand
  std::array<int, kMostJoints> position{};  ///< where its angle stands
  ArmVector low{}, high{};                  ///< rad
  ArmVector torque_limit{};                 ///< N.m, either way: of the motors on the joint
  DhChain chain;
};

/// Puts hinges at zero and all else where the model begins. Context: setup.
void stand_at_zero(const mjModel_* model, mjData_* state);

/// Finds the arm that ends at the body or site `tip`; an empty text stands for the body with the most hinges between
/// itself and the world. Refuses an unknown tip, a joint on the way that is no hinge, no joint, more than kMostJoints,
/// limits that are not in order.
/// Context: setup; moves `state` to zero.
Result<ArmModel> find_arm(const mjModel_* model, mjData_* state, const char* tip);

}  // namespace chimera::library
