// SPDX-License-Identifier: Apache-2.0
// Finds the arm in a MuJoCo model: its joints, limits and kinematic constants.
#pragma once

#include <array>
#include <cstddef>

#include "chimera/base/result.h"
#include "library/model_text/urdf_chain.h"

struct mjModel_;
struct mjData_;

namespace chimera::library {

using ArmVector = std::array<double, kMostJoints>;  ///< one number a joint, base to tip; the rest is 0

/// The hinges from the world to the tip. Other parts that move obey physics but have no drive.
struct ArmModel {
  std::size_t ndof = 0;
  std::array<int, kMostJoints> dof{};       ///< index of the joint's velocity and force
  std::array<int, kMostJoints> position{};  ///< index of the joint's angle
  ArmVector low{}, high{};                  ///< rad
  ArmVector speed_limit{};                  ///< rad/s
  ArmVector torque_limit{};                 ///< N.m, of the motors on the joint, in both directions
  std::array<bool, kMostJoints> is_continuous{};  ///< turns without end
  DhChain chain;
};

/// Sets hinges to zero and everything else to the initial state of the model. Context: setup.
void stand_at_zero(const mjModel_* model, mjData_* state);

/// Finds the arm that ends at the body or site `tip`. An empty text means the body with the most hinges between itself
/// and the world. Refuses an unknown tip, a joint on the way that is no hinge, no joint, more than kMostJoints, limits
/// out of order. Context: setup; moves `state` to zero.
Result<ArmModel> find_arm(const mjModel_* model, mjData_* state, const char* tip);

/// Finds the joints of `chain`, which was read from the same URDF file, and gives them its limits. Refuses a joint that
/// `model` lacks or has in another place, because its <compiler> moves it. Context: setup; moves `state` to zero.
Result<ArmModel> find_arm(mjModel_* model, mjData_* state, const UrdfChain& chain);

}  // namespace chimera::library
