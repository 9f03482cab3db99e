// SPDX-License-Identifier: Apache-2.0
// Robot interface with position commands, for any simulated arm.
#include "library/mujoco/robot_face.h"

using namespace chimera;

namespace {

struct MujocoRobot : library::RobotFace {
  In<double[]> q_ref{"q_ref", "rad", "[ndof<=10]", frame = "joint", doc = "Wanted position; cut at the joint limits."};
  InConst<double> bandwidth{"bandwidth", "rad/s", initial = 100.0, range(1, 200),
                            doc = "Angular frequency at which a joint error decays."};
  InConst<double> speed_limit{"speed_limit", "rad/s", initial = 3.0, range(0.01, 100), doc = "Largest joint speed."};
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
  Outcome cycle(Cycle c) { return move(library::ArmInterface::kPosition, q_ref, c); }

 private:
  void set_drives() {
    arm_.set_drives({.bandwidth = *bandwidth, .speed_limit = *speed_limit, .acceleration_limit = *acceleration_limit});
  }
};

CHIMERA_COMPONENT(MujocoRobot, "mujoco_robot", "Position-mode robot of any MJCF or URDF file, simulated.",
                  rate = 1000.0, source = "1994 paper, figures 4, 8 and 9");

}  // namespace
