// SPDX-License-Identifier: Apache-2.0
// The torque-mode robot interface of figure 4 (1994 paper), with a simulated Puma 560.
#include <algorithm>

#include "library/puma_torque/puma_body.h"

using namespace chimera;

namespace {

struct PumaTorque : library::PumaBody {
  In<double[]> tau{"tau", "N.m", "[ndof<=10]", frame = "joint", doc = "Torque at each joint, base to wrist."};
  InConst<double[]> start_pose{"start_pose", "rad", "[ndof<=10]", frame = "joint",
                               doc = "Where the arm stands at init, within the joint limits."};
  InConst<double> payload_mass{"payload_mass", "kg", initial = 0.0, range(0, 10), doc = "Bolted to the flange."};
  InConst<double> coulomb_share{"coulomb_share", "1", initial = 0.0, range(0, 1),
                                doc = "Share of the published Coulomb friction."};
  OutConst<std::int32_t> ndof{"ndof", "1", doc = "Joints: 6."};
  OutConst<library::DhLink[]> dh{"dh", "1", "[ndof<=10]", doc = "Denavit-Hartenberg rows, base to tip."};
  OutConst<Pose> base{"base", "1", frame = "base", doc = "Frame 0."};
  OutConst<Pose> tool{"tool", "1", frame = "last", doc = "The flange in frame ndof."};
  OutConst<library::LinkMass[]> links{"links", "1", "[ndof<=10]",
                                      doc = "Mass and drive of each link, base to tip, without payload."};
  OutConst<double[]> q_min{"q_min", "rad", "[ndof<=10]", frame = "joint", doc = "Lower joint limits."};
  OutConst<double[]> q_max{"q_max", "rad", "[ndof<=10]", frame = "joint", doc = "Upper joint limits."};
  OutConst<double[]> tau_max{"tau_max", "N.m", "[ndof<=10]", frame = "joint", doc = "Largest torque of the drives."};
  Resource model{"model", shared, doc = "MJCF file; puma560.xml without a directory is built in."};

  void init() {
    load();
    check(arm_.place(PumaInput(start_pose.begin(), library::kPumaJoints)));
  }
  // Changes the payload and keeps the place, at rest.
  void reinit() {
    restart([this] { load(); });
  }
  Outcome cycle(Cycle c) {
    const PumaInput torque(tau.begin(), library::kPumaJoints);
    return after(c.illegal() ? arm_.step_locally_stable(c.dt()) : arm_.step(torque, c.dt()), c.illegal());
  }

 private:
  using PumaInput = library::PumaInput;

  void load() {
    check(arm_.load(model.c_str(), {.payload_mass = *payload_mass, .coulomb_share = *coulomb_share}));
    *ndof = static_cast<std::int32_t>(library::kPumaJoints);
    std::copy_n(arm_.chain().dh.begin(), library::kPumaJoints, dh.begin());
    *base = arm_.chain().base;
    *tool = arm_.chain().tool;
    std::copy_n(arm_.links().begin(), library::kPumaJoints, links.begin());
    std::copy_n(arm_.lower_limit().begin(), library::kPumaJoints, q_min.begin());
    std::copy_n(arm_.upper_limit().begin(), library::kPumaJoints, q_max.begin());
    std::ranges::copy(arm_.torque_limit(), tau_max.begin());
  }
};

CHIMERA_COMPONENT(PumaTorque, "puma_torque", "Torque-mode Puma 560, simulated.", rate = 1000.0,
                  source = "1994 paper, figure 4; Corke and Armstrong-Helouvry, ICRA 1994");

}  // namespace
