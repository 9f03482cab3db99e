// SPDX-License-Identifier: Apache-2.0
// What the links of an arm weigh, as its MuJoCo model says: so that a controller that knows the arm need not be told.
#pragma once

#include <array>

#include "library/kinematics/dh_dynamics.h"
#include "library/mujoco/arm_model.h"

namespace chimera::library {

/// One a joint of `arm`, in its Denavit-Hartenberg frame; the rest is 0. A link is all that its joint moves and the
/// next does not, at zero: what turns or slides on it counts as fixed there. Dry friction is not in it.
/// Context: setup; moves `state` to zero.
std::array<LinkMass, kMostJoints> link_masses(const mjModel_* model, mjData_* state, const ArmModel& arm);

}  // namespace chimera::library
