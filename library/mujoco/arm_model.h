// SPDX-License-Identifier: Apache-2.0
// Finds the arm in a MuJoCo model: its joints, limits and kinematic constants.
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

/// The hinges from the world to the tip. Other parts that move obey physics but have no drive.
struct ArmModel {
  std::size_t ndof = 0;
  std::array<int, kMostJoints> dof{};       ///< index of the joint's velocity and force
  std::array<int, kMostJoints> position{};  ///< index of the joint's angle
  ArmVector low{}, high{};                  ///< rad
  ArmVector torque_limit{};                 ///< N.m, of the motors on the joint, in both directions
  DhChain chain;
};

/// Sets hinges to zero and everything else to the initial state of the model. Context: setup.
void stand_at_zero(const mjModel_* model, mjData_* state);

/// Finds the arm that ends at the body or site `tip`. An empty text means the body with the most hinges between itself
/// and the world. Refuses an unknown tip, a joint on the way that is no hinge, no joint, more than kMostJoints, limits
/// out of order. Context: setup; moves `state` to zero.
Result<ArmModel> find_arm(const mjModel_* model, mjData_* state, const char* tip);

}  // namespace chimera::library
