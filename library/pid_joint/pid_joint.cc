// SPDX-License-Identifier: Apache-2.0
// The PID joint position controller of figure 4 (1994 paper): one independent axis for each joint.
#include <algorithm>
#include <cmath>
#include <span>

#include "chimera/task/component.h"
#include "library/pid/pid_axis.h"
#include "library/signals/input.h"
#include "library/signals/short_way.h"

using namespace chimera;

namespace {

constexpr std::size_t kMostJoints = 10;

struct PidJoint {
  In<double[]> q_ref{"q_ref", "rad", "[ndof<=10]", frame = "joint", doc = "Reference positions."};
  In<double[]> qd_ref{"qd_ref", "rad/s", "[ndof<=10]", frame = "joint", doc = "Reference velocities."};
  In<double[]> q{"q", "rad", "[ndof<=10]", frame = "joint", doc = "Measured positions."};
  In<double[]> qd{"qd", "rad/s", "[ndof<=10]", frame = "joint", doc = "Measured velocities."};
  In<double[]> kp{"kp", "N.m/rad", "[ndof<=10]", doc = "Gain of the position error."};
  In<double[]> ki{"ki", "N.m/(rad.s)", "[ndof<=10]", doc = "Gain of its integral."};
  In<double[]> kd{"kd", "N.m.s/rad", "[ndof<=10]", doc = "Gain of the velocity error."};
  Out<double[]> tau{"tau", "N.m", "[ndof<=10]", frame = "joint", initial = 0.0, safety, range(-200, 200),
                    doc = "Torque for each joint, within tau_max."};
  InConst<std::int32_t> ndof{"ndof", "1", range(1, 10), doc = "Joints."};
  InConst<double[]> tau_max{"tau_max", "N.m", "[ndof<=10]", range(0, 200), frame = "joint",
                            doc = "Largest torque of the drives."};
  InConst<bool[]> is_continuous{"is_continuous", "1", "[ndof<=10]", initial = false,
                                doc = "The joint turns without end: the error is the short way."};
  InConst<double> filter_time{"filter_time", "s", initial = 2e-3, range(0, 1),
                              doc = "Time constant of the velocity filter; 0 for none."};

  Outcome init() {
    for (double limit : tau_max)
      if (!(limit >= 0 && limit <= 200)) return fault("tau_max must be 0 to 200 N.m, the range of tau");
    if (!(*filter_time >= 0)) return fault("filter_time must be 0 s or more");
    return ok();
  }
  Outcome reinit() { return init(); }

  // Bumpless: continues from the torque that is handed over. An outdated torque belongs to another state of the arm.
  void on() {
    for (double& torque : tau)
      if (tau.is_outdated() || std::isnan(torque)) torque = 0;
    begin();
  }
  Outcome cycle(Cycle c) {
    // While the configuration is illegal, the robot holds itself, so the errors must not be integrated.
    if (c.illegal()) {
      begin();
      return ok();
    }
    const Outcome inputs = judge_all();
    if (!library::is_ok(inputs)) return inputs;
    if (!is_started_) begin();
    double torque[kMostJoints];
    for (std::size_t i = 0; i < tau.size(); ++i) {
      torque[i] = axis_[i].step(gains(i), error_of(i), qd_ref[i] - qd[i], c.dt(), *filter_time, -tau_max[i],
                                tau_max[i]);
    }
    is_started_ = library::all_finite(std::span(torque, tau.size()));
    if (!is_started_) return fault("the torque is not finite: the gains or the inputs are too large");
    std::copy_n(torque, tau.size(), tau.begin());
    return ok();
  }
  bool error() { return true; }
  // There is no off(): the last torque holds for a successor. A robot without a controller is an illegal configuration,
  // in which the robot holds itself, so stopping needs no zero here.

 private:
  // Continues from the last torque. Waits for an input that was never written or is not finite.
  void begin() {
    is_started_ = library::is_ok(judge_all());
    for (std::size_t i = 0; is_started_ && i < tau.size(); ++i)
      axis_[i].start(gains(i), error_of(i), qd_ref[i] - qd[i], tau[i]);
  }
  Outcome judge_all() const {
    Outcome found = library::judge(q, "q");
    if (library::is_ok(found)) found = library::judge(qd, "qd");
    if (library::is_ok(found)) found = library::judge(q_ref, "q_ref");
    if (library::is_ok(found)) found = library::judge(qd_ref, "qd_ref");
    if (library::is_ok(found)) found = library::judge(kp, "kp");
    if (library::is_ok(found)) found = library::judge(ki, "ki");
    if (library::is_ok(found)) found = library::judge(kd, "kd");
    return found;
  }
  double error_of(std::size_t i) const { return library::short_way(q_ref[i] - q[i], is_continuous[i]); }
  library::PidGains gains(std::size_t i) const { return {kp[i], ki[i], kd[i]}; }

  library::PidAxis axis_[kMostJoints];
  bool is_started_ = false;
};

CHIMERA_COMPONENT(PidJoint, "pid_joint", "Independent joint PID with anti-windup and filtered derivative.",
                  rate = 1000.0, source = "1994 paper, figure 4; Astrom and Hagglund 2006");

}  // namespace
