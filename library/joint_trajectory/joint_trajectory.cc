// SPDX-License-Identifier: Apache-2.0
// The joint trajectory generator of figure 4 (1994 paper): from the measured motion, or from that of a predecessor, to
// rest; then it holds. README.md is the data sheet.
#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "chimera/base/fixed.h"
#include "chimera/base/message.h"
#include "chimera/base/number_text.h"
#include "chimera/task/component.h"
#include "library/joint_trajectory/braking.h"
#include "library/joint_trajectory/quintic.h"
#include "library/joint_trajectory/seven_segments.h"
#include "library/signals/short_way.h"

using namespace chimera;

namespace {

constexpr std::size_t kMostJoints = 10;

struct JointTrajectory {
  Many<In<double[]>, 1> q{"q*", "rad", "[ndof<=10]", frame = "joint",
                          doc = "Measured positions, for on; may be left out."};
  Many<In<double[]>, 1> qd{"qd*", "rad/s", "[ndof<=10]", frame = "joint",
                           doc = "Measured velocities, for on; may be left out."};
  Out<double[]> q_ref{"q_ref", "rad", "[ndof<=10]", frame = "joint", doc = "Reference positions."};
  Out<double[]> qd_ref{"qd_ref", "rad/s", "[ndof<=10]", frame = "joint", doc = "Reference velocities."};
  Out<double[]> qdd_ref{"qdd_ref", "rad/s2", "[ndof<=10]", frame = "joint", doc = "Reference accelerations."};
  InConst<std::int32_t> ndof{"ndof", "1", range(1, 10), doc = "Joints."};
  InConst<double[]> start_pose{"start_pose", "rad", "[ndof<=10]", frame = "joint",
                               doc = "Where the first motion starts if q is left out."};
  InConst<double[]> goal{"goal", "rad", "[ndof<=10]", frame = "joint", doc = "Where each motion ends."};
  InConst<double> duration{"duration", "s", initial = 0.0, range(0, 3600),
                           doc = "Time from rest to rest; with limits the least time."};
  InConst<Text<16>> profile{"profile", "1", initial = "quintic", one_of = "quintic trapezoid jerk",
                            doc = "Shape of the motion."};
  InConst<double[]> velocity_max{"velocity_max", "rad/s", "[ndof<=10]", range(0, 1e6), frame = "joint", initial = 1.0,
                                 doc = "Limit for trapezoid and jerk."};
  InConst<double[]> acceleration_max{"acceleration_max", "rad/s2", "[ndof<=10]", range(0, 1e6), frame = "joint",
                                     initial = 2.0, doc = "Limit for trapezoid and jerk."};
  InConst<double[]> jerk_max{"jerk_max", "rad/s3", "[ndof<=10]", range(0, 1e9), frame = "joint", initial = 20.0,
                             doc = "Limit for jerk."};
  InConst<bool[]> is_continuous{"is_continuous", "1", "[ndof<=10]", initial = false,
                                doc = "The joint turns without end: the goal is reached the short way."};
  InConst<bool> is_synchronised{"is_synchronised", "1", initial = true,
                                doc = "With limits all joints arrive with the slowest."};

  Outcome init() {
    is_quintic_ = *profile == "quintic";
    has_jerk_ = *profile == "jerk";
    if (!is_quintic_ && !has_jerk_ && *profile != "trapezoid")
      return fault("profile must be quintic, trapezoid or jerk");
    if (is_quintic_ && !(*duration > 0)) return fault("duration must be above 0 s");
    if (!(*duration >= 0 && *duration <= 3600)) return fault("duration must be 0 to 3600 s");
    for (const auto* pose : {&start_pose, &goal})
      for (double angle : *pose)
        if (!std::isfinite(angle)) return fault("start_pose and goal must be finite");
    if (is_quintic_) return ok();
    for (const auto* limit : {&velocity_max, &acceleration_max, &jerk_max})
      for (double most : *limit)
        if (!(most > 0) || !std::isfinite(most))
          return fault("velocity_max, acceleration_max and jerk_max must be above 0");
    return ok();
  }
  Outcome reinit() { return init(); }

  void on(Cycle c) {
    stood_ = false;
    start(c, q_ref.is_handed_over());
  }
  // While the configuration is illegal, the arm holds itself, so the reference waits; then it starts where the arm is.
  void cycle(Cycle c) {
    if (c.illegal()) {
      if (!stood_) off();
      stood_ = true;
      return;
    }
    if (std::exchange(stood_, false)) return start(c, false);
    elapsed_ += c.dt();
    publish();
  }
  // Holds the last position at rest, because the controller of the arm still follows it.
  void off() {
    for (std::size_t i = 0; i < q_ref.size(); ++i) qd_ref[i] = qdd_ref[i] = 0;
  }

 private:
  using Motion = library::Motion;

  /// From the reference that is handed over, else from the measured motion, else from the last reference at rest.
  void start(Cycle c, bool goes_on) {
    elapsed_ = 0;
    for (std::size_t i = 0; i < q_ref.size(); ++i) {
      const Motion from = beginning(i, goes_on);
      const double to = end(i, from.position);
      if (is_quintic_) {
        path_[i] = {from.position, to, *duration, from.velocity, from.acceleration};
        continue;
      }
      const double jerk = has_jerk_ ? jerk_max[i] : std::numeric_limits<double>::infinity();
      const library::MotionLimits limits{velocity_max[i], acceleration_max[i], jerk};
      tell_if_beyond(c, i, from, limits);
      braking_[i] = library::Braking(from, limits);
      limited_[i] = library::SevenSegments(braking_[i].rest(), to, limits);
    }
    if (!is_quintic_) stretch();
    publish();
  }
  Motion beginning(std::size_t i, bool goes_on) const {
    const bool is_measured = q.size() > 0 && std::isfinite(q[0][i]);
    if (is_measured && !(goes_on && std::isfinite(q_ref[i])))
      return {q[0][i], qd.size() > 0 && std::isfinite(qd[0][i]) ? qd[0][i] : 0, 0};
    if (!std::isfinite(q_ref[i])) return {start_pose[i], 0, 0};
    Motion from{q_ref[i], 0, 0};
    if (qd_ref.is_handed_over() && goes_on && std::isfinite(qd_ref[i])) {
      from.velocity = qd_ref[i];
      if (qdd_ref.is_handed_over() && std::isfinite(qdd_ref[i])) from.acceleration = qdd_ref[i];
    }
    return from;
  }
  double end(std::size_t i, double from) const {
    return is_continuous[i] ? from + library::short_way(goal[i] - from, true) : goal[i];
  }
  static void tell_if_beyond(Cycle c, std::size_t i, const Motion& from, const library::MotionLimits& limits) {
    const double speed = std::abs(from.velocity), acceleration = std::abs(from.acceleration);
    if (speed <= limits.velocity && acceleration <= limits.acceleration) return;
    Message text("joint ");
    text << i + 1 << " starts at " << number_text(speed, 3).view() << " rad/s, " << number_text(acceleration, 3).view()
         << " rad/s2, beyond its limits " << number_text(limits.velocity, 3).view() << " and "
         << number_text(limits.acceleration, 3).view() << ": brakes first, may pass the goal";
    c.note(FixedString<159>(text.view()).c_str());
  }
  void stretch() {
    double longest = *duration, last_stop = 0;
    for (std::size_t i = 0; *is_synchronised && i < q_ref.size(); ++i) {
      longest = std::max(longest, limited_[i].least_duration());
      last_stop = std::max(last_stop, braking_[i].duration());
    }
    for (std::size_t i = 0; i < q_ref.size(); ++i) {
      limited_[i].stretch(longest);
      starts_at_[i] = *is_synchronised ? last_stop : braking_[i].duration();
    }
  }
  Motion limited(std::size_t i) const {
    return elapsed_ < starts_at_[i] ? braking_[i].at(elapsed_) : limited_[i].at(elapsed_ - starts_at_[i]);
  }
  void publish() {
    for (std::size_t i = 0; i < q_ref.size(); ++i) {
      const Motion motion = is_quintic_ ? path_[i].at(elapsed_) : limited(i);
      q_ref[i] = motion.position;
      qd_ref[i] = motion.velocity;
      qdd_ref[i] = motion.acceleration;
    }
  }

  library::Quintic path_[kMostJoints];
  library::Braking braking_[kMostJoints];  // to rest, before a motion with limits
  library::SevenSegments limited_[kMostJoints];
  double starts_at_[kMostJoints] = {};  // s, start of that motion
  bool is_quintic_ = true, has_jerk_ = false;
  bool stood_ = false;  // the flag was up in the last cycle
  double elapsed_ = 0;
};

CHIMERA_COMPONENT(JointTrajectory, "joint_trajectory", "Joint motion from rest to rest, then hold.", rate = 1000.0,
                  source = "1994 paper, figure 4; Craig 2005, section 7.3; Biagiotti and Melchiorri 2008");

}  // namespace
