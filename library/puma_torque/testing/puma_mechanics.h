// SPDX-License-Identifier: Apache-2.0
// What MuJoCo computes of a Puma 560 in its present state, for comparison with published values.
#pragma once

#include <mujoco/mujoco.h>

#include <algorithm>
#include <array>

#include "library/puma_torque/puma_arm.h"

namespace chimera::library {

/// Gravity, centrifugal and Coriolis torque in the present state (N.m): the torque that holds the arm at rest.
inline PumaVector bias_torque(PumaArm& arm) {
  const SimulatedArm& simulated = arm.simulation();
  mj_forward(simulated.model(), simulated.state());
  PumaVector torque;
  std::copy_n(simulated.state()->qfrc_bias, kPumaJoints, torque.begin());
  return torque;
}

/// Joint-space mass matrix with motor inertias, row by row (kg.m2).
inline std::array<double, kPumaJoints * kPumaJoints> mass_matrix(PumaArm& arm) {
  const SimulatedArm& simulated = arm.simulation();
  mj_forward(simulated.model(), simulated.state());
  std::array<double, kPumaJoints * kPumaJoints> full;
  mj_fullM(simulated.model(), full.data(), simulated.state()->qM);
  return full;
}

/// Position of the wrist centre (frame 6) in the base frame (m).
inline std::array<double, 3> wrist_position(const PumaArm& arm) {
  const SimulatedArm& simulated = arm.simulation();
  const double* p = simulated.state()->xpos + 3 * mj_name2id(simulated.model(), mjOBJ_BODY, "link6");
  return {p[0], p[1], p[2]};
}

/// Rotation of the wrist (frame 6) in the base frame, row by row.
inline std::array<double, 9> wrist_rotation(const PumaArm& arm) {
  const SimulatedArm& simulated = arm.simulation();
  std::array<double, 9> rotation;
  std::copy_n(simulated.state()->xmat + 9 * mj_name2id(simulated.model(), mjOBJ_BODY, "link6"), 9, rotation.begin());
  return rotation;
}

}  // namespace chimera::library
