// SPDX-License-Identifier: Apache-2.0
// Robot interface with velocity commands, for any simulated arm.
#include "library/mujoco/robot_face.h"

using namespace chimera;

namespace {

struct MujocoRobotVelocity : library::RobotFace {
  In<double[]> qd_ref{"qd_ref", "rad/s", "[ndof<=10]", frame = "joint",
                      doc = "Wanted velocity; lower before a joint limit."};
  InConst<double> bandwidth{"bandwidth", "rad/s", initial = 100.0, range(1, 200),
                            doc = "Angular frequency at which a joint error decays."};
  InConst<double> acceleration_limit{"acceleration_limit", "rad/s2", initial = 20.0, range(0.1, 1000),
                                     doc = "Largest joint acceleration."};

  void init(Cycle c) {
    set_drives();
    RobotFace::init(c);
  }
  void reinit() {
    set_drives();
    RobotFace::reinit();
  }
  Outcome cycle(Cycle c) { return move(library::ArmInterface::kVelocity, qd_ref, c); }

 private:
  void set_drives() {
    arm_.set_drives({.bandwidth = *bandwidth, .acceleration_limit = *acceleration_limit});
  }
};

CHIMERA_COMPONENT(MujocoRobotVelocity, "mujoco_robot_velocity", "Velocity-mode robot of any MJCF or URDF file.",
                  rate = 1000.0, source = "1994 paper, figures 4, 8 and 9");

}  // namespace
