// SPDX-License-Identifier: Apache-2.0
// The simulated Puma 560 in position mode (2000 paper, figure 3). The arm is that of library/puma_torque.
#include <algorithm>

#include "library/kinematics/puma560.h"
#include "library/puma_torque/puma_body.h"

using namespace chimera;

namespace {

struct Puma : library::PumaBody {
  In<double[]> q_ref{"q_ref", "rad", "[ndof<=10]", frame = "joint", doc = "Wanted position."};
  InConst<double[]> start_pose{"start_pose", "rad", "[ndof<=10]", initial = 0.0, frame = "joint",
                               doc = "Where the arm stands at init, within the joint limits."};
  InConst<double> bandwidth{"bandwidth", "rad/s", initial = 100.0, range(1, 200),
                            doc = "Angular frequency at which a joint error decays."};
  InConst<double> speed_limit{"speed_limit", "rad/s", initial = 1.5, range(0.01, 10), doc = "Largest joint speed."};
  InConst<double> payload_mass{"payload_mass", "kg", initial = 0.0, range(0, 10), doc = "Bolted to the flange."};
  OutConst<std::int32_t> ndof{"ndof", "1", doc = "Joints: 6."};
  OutConst<library::DhLink[]> dh{"dh", "1", "[ndof<=10]", doc = "Denavit-Hartenberg rows, base to flange."};
  OutConst<double[]> q_min{"q_min", "rad", "[ndof<=10]", frame = "joint", doc = "Lower joint limits."};
  OutConst<double[]> q_max{"q_max", "rad", "[ndof<=10]", frame = "joint", doc = "Upper joint limits."};

  void init() {
    load();
    check(arm_.place(Joints(start_pose.begin(), 6)));
  }
  // Changes payload or drives and keeps the place, at rest.
  void reinit() {
    restart([this] { load(); });
  }
  Outcome cycle(Cycle c) {
    const bool moved = c.illegal() ? arm_.step_locally_stable(c.dt())
                                   : arm_.step(library::ArmInterface::kPosition, Joints(q_ref.begin(), 6), c.dt());
    return after(moved, c.illegal());
  }

 private:
  using Joints = library::PumaInput;

  void load() {
    arm_.set_drives({.bandwidth = *bandwidth, .speed_limit = *speed_limit, .acceleration_limit = 15});
    check(arm_.load(library::kPumaModel, {.payload_mass = *payload_mass, .coulomb_share = 0}));
    *ndof = 6;
    std::ranges::copy(library::Puma560::kRows, dh.begin());
    std::ranges::copy(library::Puma560::kLow, q_min.begin());
    std::ranges::copy(library::Puma560::kHigh, q_max.begin());
  }
};

CHIMERA_COMPONENT(Puma, "puma", "Position-mode Puma 560, simulated.", rate = 1000.0,
                  source = "2000 paper, table 1 and figure 3");

}  // namespace
