// SPDX-License-Identifier: Apache-2.0
// Robot interface with torque commands, for any simulated arm.
#include "library/mujoco/link_masses.h"
#include "library/mujoco/robot_face.h"

using namespace chimera;

namespace {

struct MujocoRobotTorque : library::RobotFace {
  In<double[]> tau{"tau", "N.m", "[ndof<=10]", frame = "joint", doc = "Torque at each joint; cut at tau_max."};
  OutConst<library::LinkMass[]> links{"links", "1", "[ndof<=10]", doc = "Mass and drive of each link, base to tip."};

  void init(Cycle c) {
    start([this] { return load_with_links(); });
    tell_note(c);
  }
  void reinit() {
    restart([this] { return load_with_links(); });
  }
  Outcome cycle(Cycle c) { return move(library::ArmInterface::kTorque, tau, c); }

 private:
  Result<void> load_with_links() {
    Result<void> loaded = arm_.load(model.c_str(), tip->c_str());
    if (!loaded) return loaded;
    const auto found = library::link_masses(arm_.model(), arm_.state(), arm_.arm());
    std::copy_n(found.begin(), arm_.joints(), links.begin());
    return loaded;
  }
};

CHIMERA_COMPONENT(MujocoRobotTorque, "mujoco_robot_torque", "Torque-mode robot of any MJCF or URDF file.",
                  rate = 1000.0, source = "1994 paper, figures 4, 8 and 9");

}  // namespace
