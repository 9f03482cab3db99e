// SPDX-License-Identifier: Apache-2.0
// Computed-torque control: compensates the dynamics of the arm, so that each joint follows its reference independently.
#include "library/kinematics/dh_dynamics.h"
#include "library/kinematics/dh_ports.h"
#include "library/signals/input.h"
#include "library/signals/short_way.h"

using namespace chimera;

namespace {

struct ComputedTorque : library::DhPorts {
  In<double[]> q_ref{"q_ref", "rad", "[ndof<=10]", frame = "joint", doc = "Reference positions."};
  In<double[]> qd_ref{"qd_ref", "rad/s", "[ndof<=10]", frame = "joint", doc = "Reference velocities."};
  In<double[]> qdd_ref{"qdd_ref", "rad/s2", "[ndof<=10]", frame = "joint", doc = "Reference accelerations."};
  In<double[]> q{"q", "rad", "[ndof<=10]", frame = "joint", doc = "Measured positions."};
  In<double[]> qd{"qd", "rad/s", "[ndof<=10]", frame = "joint", doc = "Measured velocities."};
  Out<double[]> tau{"tau", "N.m", "[ndof<=10]", frame = "joint", initial = 0.0, safety,
                    doc = "Torque for each joint, within tau_max."};
  InConst<library::LinkMass[]> links{"links", "1", "[ndof<=10]", doc = "Mass and drive of each link, base to tip."};
  InConst<double[]> tau_max{"tau_max", "N.m", "[ndof<=10]", range(0, 1e6), frame = "joint",
                            doc = "Largest torque of the drives."};
  InConst<bool[]> is_continuous{"is_continuous", "1", "[ndof<=10]", initial = false,
                                doc = "The joint turns without end: the error is the short way."};
  InConst<double> bandwidth{"bandwidth", "rad/s", initial = 20.0, range(0, 500),
                            doc = "Angular frequency at which an error decays; 0: no feedback."};
  InConst<double> damping_ratio{"damping_ratio", "1", initial = 1.0, range(0, 10), doc = "1: no overshoot."};
  InConst<double> payload_mass{"payload_mass", "kg", initial = 0.0, range(0, 1000), doc = "Point mass at the tool."};
  InConst<double[3]> gravity{"gravity", "m/s2", initial = {0.0, 0.0, -9.81}, frame = "base",
                             doc = "Acceleration of gravity."};

  Outcome init() {
    const DhChain chain = read_chain();
    for (std::size_t i = 0; i < links.size(); ++i) {
      if (const char* why = refusal(links[i])) return fault(why);
    }
    for (double limit : tau_max) {
      if (!(limit >= 0)) return fault("tau_max must be 0 N.m or more");
    }
    const library::Vec3 falls{gravity[0], gravity[1], gravity[2]};
    if (!std::isfinite(library::length(falls))) return fault("gravity is not finite");
    dynamics_ = library::ArmDynamics(chain, links.span(), falls, *payload_mass);
    return ok();
  }
  Outcome reinit() { return init(); }
  // The law has no state, so its output does not depend on the previous controller.
  Outcome on() { return library::awaited(follow()); }
  Outcome cycle(Cycle c) { return c.illegal() ? ok() : follow(); }
  bool error() { return true; }
  // There is no off(): the last torque holds, as that of pid_joint.

 private:
  using DhChain = library::DhChain;

  static const char* refusal(const library::LinkMass& link) {
    double sum = link.mass + link.rotor + link.friction;
    for (double part : link.centre) sum += part;
    for (double part : link.inertia) sum += part;
    if (!std::isfinite(sum)) return "links: a number is not finite";
    if (link.mass < 0 || link.rotor < 0 || link.friction < 0) return "links: mass, rotor and friction are 0 or more";
    for (std::size_t i = 0; i < 3; ++i) {
      if (link.inertia[i] < 0) return "links: the inertia about an axis is 0 or more";
    }
    return nullptr;
  }
  Outcome follow() {
    std::array<double, library::kMostJoints> wanted{}, torque{};
    const double w = *bandwidth;
    for (std::size_t i = 0; i < tau.size(); ++i) {
      const double error = library::short_way(q_ref[i] - q[i], is_continuous[i]);
      wanted[i] = qdd_ref[i] + 2 * *damping_ratio * w * (qd_ref[i] - qd[i]) + w * w * error;
    }
    dynamics_.torque(q.span(), qd.span(), {wanted.data(), tau.size()}, torque);
    for (std::size_t i = 0; i < tau.size(); ++i) {
      if (std::isnan(torque[i])) return library::unfit("an input is not finite", q_ref, qd_ref, qdd_ref, q, qd);
    }
    for (std::size_t i = 0; i < tau.size(); ++i) tau[i] = std::clamp(torque[i], -tau_max[i], tau_max[i]);
    return ok();
  }

  library::ArmDynamics dynamics_;
};

CHIMERA_COMPONENT(ComputedTorque, "computed_torque", "Computed-torque control of any serial arm.", rate = 1000.0,
                  source = "Luh, Walker and Paul 1980; Markiewicz 1973");

}  // namespace
