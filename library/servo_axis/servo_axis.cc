// SPDX-License-Identifier: Apache-2.0
// Simulates independent axes with inertia and friction, driven by torques. README.md is the data sheet.
#include "chimera/task/component.h"
#include "library/servo_axis/friction_axis.h"
#include "library/signals/input.h"

using namespace chimera;

namespace {

constexpr std::size_t kMostJoints = 10;
constexpr double kMostTorque = 1e9;  // N.m: every motion stays finite

struct ServoAxis {
  In<double[]> tau{"tau", "N.m", "[ndof<=10]", frame = "joint", range(-kMostTorque, kMostTorque),
                   doc = "Torque of each drive."};
  Out<double[]> q{"q", "rad", "[ndof<=10]", frame = "joint", doc = "Positions."};
  Out<double[]> qd{"qd", "rad/s", "[ndof<=10]", frame = "joint", doc = "Velocities."};
  InConst<std::int32_t> ndof{"ndof", "1", range(1, 10), doc = "Axes."};
  InConst<double[]> inertia{"inertia", "kg.m2", "[ndof<=10]", range(1e-9, 1e6), frame = "joint",
                            doc = "Of rotor and load."};
  InConst<double[]> viscous{"viscous", "N.m.s/rad", "[ndof<=10]", initial = 0.0, range(0, 1e6), frame = "joint",
                            doc = "Friction by velocity."};
  InConst<double[]> coulomb{"coulomb", "N.m", "[ndof<=10]", initial = 0.0, range(0, 1e6), frame = "joint",
                            doc = "Friction against every motion; holds an axis at rest."};
  InConst<double[]> start_pose{"start_pose", "rad", "[ndof<=10]", initial = 0.0, range(-1e6, 1e6), frame = "joint",
                               doc = "Positions at init, at rest."};

  Outcome init() {
    const Outcome made = reinit();
    for (std::size_t i = 0; i < q.size(); ++i) axis_[i].place(start_pose[i], 0);
    return made;
  }
  // Changes the load and keeps the motion.
  Outcome reinit() {
    for (std::size_t i = 0; i < q.size(); ++i) {
      if (!(inertia[i] >= 1e-9 && inertia[i] <= 1e6)) return fault("inertia is 1e-9 to 1e6 kg.m2");
      if (!(viscous[i] >= 0 && viscous[i] <= 1e6)) return fault("viscous is 0 to 1e6 N.m.s/rad");
      if (!(coulomb[i] >= 0 && coulomb[i] <= 1e6)) return fault("coulomb is 0 to 1e6 N.m");
      if (!(math::fabs(start_pose[i]) <= 1e6)) return fault("start_pose is -1e6 to 1e6 rad");
      axis_[i].refit({inertia[i], viscous[i], coulomb[i]});
    }
    return ok();
  }
  // Continues the motion that another plant hands over.
  void on() {
    const bool goes_on = q.is_handed_over() && qd.is_handed_over() && library::all_finite(q) && library::all_finite(qd);
    for (std::size_t i = 0; goes_on && i < q.size(); ++i) axis_[i].place(q[i], qd[i]);
    publish();
  }
  Outcome cycle(Cycle c) {
    const Outcome input = library::judge(tau, "tau");
    if (!library::is_ok(input)) return input;
    for (const double torque : tau)
      if (math::fabs(torque) > kMostTorque) return fault("tau is -1e9 to 1e9 N.m");
    for (std::size_t i = 0; i < q.size(); ++i) {
      if (c.illegal()) axis_[i].place(axis_[i].position(), 0);
      else axis_[i].step(tau[i], c.dt());
    }
    publish();
    return ok();
  }
  bool error() { return true; }
  void off() {
    for (std::size_t i = 0; i < q.size(); ++i) axis_[i].place(axis_[i].position(), 0);
    publish();
  }

 private:
  void publish() {
    for (std::size_t i = 0; i < q.size(); ++i) q[i] = axis_[i].position(), qd[i] = axis_[i].velocity();
  }

  library::FrictionAxis axis_[kMostJoints];
};

CHIMERA_COMPONENT(ServoAxis, "servo_axis", "Simulated axes with inertia and friction, driven by torques.",
                  rate = 1000.0);

}  // namespace
