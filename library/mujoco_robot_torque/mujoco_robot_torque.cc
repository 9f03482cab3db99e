// SPDX-License-Identifier: Apache-2.0
// A robot interface of the torque kind with any simulated arm behind it.
#include "library/mujoco/robot_face.h"

using namespace chimera;

namespace {

struct MujocoRobotTorque : library::RobotFace {
  In<double[]> tau{"tau", "N.m", "[ndof<=10]", frame = "joint", doc = "Torque at each joint; cut at tau_max."};
  Outcome cycle(Cycle c) { return move(library::ArmInterface::kTorque, tau, c); }
};

CHIMERA_COMPONENT(MujocoRobotTorque, "mujoco_robot_torque", "Torque-mode robot of any MJCF or URDF file.",
                  rate = 1000.0, source = "1994 paper, figures 4, 8 and 9");

}  // namespace
