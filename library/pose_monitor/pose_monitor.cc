// SPDX-License-Identifier: Apache-2.0
// Judges how a tool follows a moving target, in variables that `--expect` compares.
#include <algorithm>
#include <cmath>

#include "chimera/task/component.h"
#include "library/kinematics/frame.h"

using namespace chimera;

namespace {

struct PoseMonitor {
  In<Pose> target{"target", frame = "base", doc = "Where the tool should be."};
  In<Pose> xm{"xm", frame = "base", doc = "Where the tool is."};
  Out<double> distance{"distance", "m", initial = 0.0, doc = "Distance now."};
  Out<double> angle{"angle", "rad", initial = 0.0, doc = "Angle between the orientations now."};
  Out<double> max_distance{"max_distance", "m", initial = 1e9, doc = "Largest after settle; 1e9 before."};
  Out<double> max_angle{"max_angle", "rad", initial = 1e9, doc = "Largest after settle; 1e9 before."};
  Out<double> target_moved{"target_moved", "m", initial = 0.0, doc = "Path of the target after settle."};
  Out<double> tool_moved{"tool_moved", "m", initial = 0.0, doc = "Path of the tool since on."};
  InConst<double> settle{"settle", "s", initial = 1.0, range(0, 3600), doc = "Time at the start that does not count."};

  void on() {
    elapsed_ = 0;
    *max_distance = *max_angle = 1e9;
    *target_moved = *tool_moved = 0;
    has_before_ = false;
  }
  Outcome cycle(Cycle c) {
    if (!target.valid() || !xm.valid()) return aborted();
    elapsed_ += c.dt();
    const Vec3 goal = place(*target), tool = place(*xm);
    *distance = library::length(goal - tool);
    *angle = library::angle_between(target->orientation, xm->orientation);
    if (!std::isfinite(*distance) || !std::isfinite(*angle)) return fault("a pose is not a number");
    const bool judged = elapsed_ > *settle - 1e-9;
    if (has_before_) {
      *tool_moved += library::length(tool - tool_before_);
      if (judged) *target_moved += library::length(goal - goal_before_);
    }
    if (judged) {
      *max_distance = *max_distance >= 1e9 ? *distance : std::max(*max_distance, *distance);
      *max_angle = *max_angle >= 1e9 ? *angle : std::max(*max_angle, *angle);
    }
    goal_before_ = goal;
    tool_before_ = tool;
    has_before_ = true;
    return ok();
  }
  bool error() { return true; }

 private:
  using Vec3 = library::Vec3;
  static Vec3 place(const Pose& pose) { return {pose.position[0], pose.position[1], pose.position[2]}; }

  Vec3 goal_before_{}, tool_before_{};
  double elapsed_ = 0;
  bool has_before_ = false;
};

CHIMERA_COMPONENT(PoseMonitor, "pose_monitor", "Judges how a tool follows a target that moves.", rate = 100.0);

}  // namespace
