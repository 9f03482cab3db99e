// SPDX-License-Identifier: Apache-2.0
// Mass properties of the links of an arm, from its MuJoCo model, for controllers that use the dynamics.
#pragma once

#include <array>

#include "library/kinematics/dh_dynamics.h"
#include "library/mujoco/arm_model.h"

namespace chimera::library {

/// One element for each joint of `arm`, in its Denavit-Hartenberg frame; the rest is 0. A link is everything that its
/// joint moves and the next joint does not, at zero. Parts that move on a link count as fixed there. Dry friction is
/// left out. Context: setup; moves `state` to zero.
std::array<LinkMass, kMostJoints> link_masses(const mjModel_* model, mjData_* state, const ArmModel& arm);

}  // namespace chimera::library
