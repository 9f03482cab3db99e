// SPDX-License-Identifier: Apache-2.0
// The joint position trajectory generator of figure 4 (1994 paper): from rest to rest on a quintic, then hold.
#include <cmath>

#include "chimera/task/component.h"
#include "library/joint_trajectory/quintic.h"

using namespace chimera;

namespace {

constexpr std::size_t kMostJoints = 10;

struct JointTrajectory {
  Out<double[]> q_ref{"q_ref", "rad", "[ndof<=10]", frame = "joint", doc = "Reference positions."};
  Out<double[]> qd_ref{"qd_ref", "rad/s", "[ndof<=10]", frame = "joint", doc = "Reference velocities."};
  Out<double[]> qdd_ref{"qdd_ref", "rad/s2", "[ndof<=10]", frame = "joint", doc = "Reference accelerations."};
  InConst<std::int32_t> ndof{"ndof", "1", range(1, 10), doc = "Joints."};
  InConst<double[]> start_pose{"start_pose", "rad", "[ndof<=10]", frame = "joint",
                               doc = "Where the first motion starts."};
  InConst<double[]> goal{"goal", "rad", "[ndof<=10]", frame = "joint", doc = "Where it ends."};
  InConst<double> duration{"duration", "s", range(1e-3, 3600), doc = "From rest to rest."};

  Outcome init() {
    if (!(*duration > 0)) return fault("duration must be above 0 s");
    for (const auto* pose : {&start_pose, &goal})
      for (double angle : *pose)
        if (!std::isfinite(angle)) return fault("start_pose and goal must be finite");
    return ok();
  }
  Outcome reinit() { return init(); }

  // A reference that stands already, of an earlier run or of a predecessor, is where the motion begins: no jump.
  void on() {
    elapsed_ = 0;
    for (std::size_t i = 0; i < q_ref.size(); ++i)
      path_[i] = {std::isnan(q_ref[i]) ? start_pose[i] : q_ref[i], goal[i], *duration};
    publish();
  }
  void cycle(Cycle c) {
    elapsed_ += c.dt();
    publish();
  }
  // At rest where it is: who holds the arm holds it there.
  void off() {
    for (std::size_t i = 0; i < q_ref.size(); ++i) qd_ref[i] = qdd_ref[i] = 0;
  }

 private:
  void publish() {
    for (std::size_t i = 0; i < q_ref.size(); ++i) {
      const library::Motion motion = path_[i].at(elapsed_);
      q_ref[i] = motion.position;
      qd_ref[i] = motion.velocity;
      qdd_ref[i] = motion.acceleration;
    }
  }

  library::Quintic path_[kMostJoints];
  double elapsed_ = 0;
};

CHIMERA_COMPONENT(JointTrajectory, "joint_trajectory", "Quintic joint motion from rest to rest, then hold.",
                  rate = 1000.0, source = "1994 paper, figure 4; Craig 2005, section 7.3");

}  // namespace
