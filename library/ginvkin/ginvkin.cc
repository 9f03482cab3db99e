// SPDX-License-Identifier: Apache-2.0
// Generalized inverse kinematics: joint positions for a tool pose of any serial arm.
#include <cstdio>

#include "library/kinematics/dh_ports.h"
#include "library/signals/input.h"

using namespace chimera;

namespace {

struct Ginvkin : library::DhPorts {
  In<Pose> xr{"xr", frame = "base", doc = "Reference tool pose."};
  In<double[]> q{"q", "rad", "[ndof<=10]", frame = "joint", doc = "Measured joint positions."};
  Out<double[]> q_ref{"q_ref", "rad", "[ndof<=10]", initial = 0.0, frame = "joint",
                      doc = "Joint positions for xr, near the last ones."};
  Out<double> residual{"residual", "1", initial = 0.0, doc = "Remaining error: the larger of metres and radians."};
  Out<bool> is_reachable{"is_reachable", "1", initial = true, doc = "The residual is within tolerance."};
  InConst<double> tolerance{"tolerance", "1", initial = 1e-6, range(1e-9, 0.1),
                            doc = "Largest residual of a reachable pose."};
  InConst<double[]> q_min{"q_min", "rad", "[ndof<=10]", initial = -1e6, frame = "joint",
                          doc = "Lower joint limits; -1e6 for none."};
  InConst<double[]> q_max{"q_max", "rad", "[ndof<=10]", initial = 1e6, at_least = "q_min", frame = "joint",
                          doc = "Upper joint limits; 1e6 for none."};
  InConst<double> speed_limit{"speed_limit", "rad/s", initial = 1e6, range(0.01, 1e6),
                              doc = "Largest joint speed of q_ref; 1e6 for none."};

  Outcome init() {
    read_chain();
    if (!(*speed_limit > 0)) return fault("speed_limit must be above 0");
    for (std::size_t i = 0; i < q_min.size(); ++i) {
      if (!(q_min[i] <= q_max[i])) return fault("a joint limit is not a number, or q_min is above q_max");
      search_.limits.low[i] = q_min[i];
      search_.limits.high[i] = q_max[i];
    }
    return ok();
  }
  Outcome reinit() {
    const Outcome outcome = init();
    cut();
    return outcome;
  }
  // Bumpless: continues from a command that is handed over, because the drives lag behind it; else starts at the
  // measured positions. From beyond a joint limit the command comes back within the speed limit.
  Outcome on(Cycle c) {
    stood_ = false;
    return start(c, q_ref.is_handed_over());
  }
  // While the configuration is illegal, the arm holds itself, so q_ref waits; then it starts where the arm is.
  Outcome cycle(Cycle c) {
    if (c.illegal()) {
      stood_ = true;
      return ok();
    }
    if (stood_) {
      const Outcome started = start(c, false);
      stood_ = !library::is_ok(started);
      return started;
    }
    if (!is_pose(*xr)) return library::unfit("xr is not finite or no orientation", xr);
    std::array<double, library::kMostJoints> q_found{};
    for (std::size_t i = 0; i < q_ref.size(); ++i) q_found[i] = search_.limits.cut(i, q_ref[i]);
    *is_reachable = search_.solve(arm_, library::frame_of(*xr), {q_found.data(), q_ref.size()}, *tolerance);
    *residual = search_.residual();
    move_to(q_found, *speed_limit * c.dt());
    return ok();
  }
  bool error() { return true; }

 private:
  Outcome start(Cycle c, bool goes_on) {
    if (!goes_on || !library::all_finite(q_ref)) {
      for (std::size_t i = 0; i < q.size(); ++i)
        if (!std::isfinite(q[i])) return fault("q is not finite: the search cannot begin there");
      std::ranges::copy(q, q_ref.begin());
    }
    for (std::size_t i = 0; i < q_ref.size(); ++i) {
      if (search_.limits.cut(i, q_ref[i]) == q_ref[i]) continue;
      char text[120];
      std::snprintf(text, sizeof text, "q_ref[%zu] starts at %.4g rad, outside %.4g to %.4g rad", i, q_ref[i], q_min[i],
                    q_max[i]);
      c.note(text);
    }
    return ok();
  }
  /// Moves to `goal`, or towards it until the fastest joint has moved by `farthest`.
  void move_to(const std::array<double, library::kMostJoints>& goal, double farthest) {
    double way = 0;
    for (std::size_t i = 0; i < q_ref.size(); ++i) way = std::max(way, std::abs(goal[i] - q_ref[i]));
    const bool is_far = way > farthest;
    for (std::size_t i = 0; i < q_ref.size(); ++i)
      q_ref[i] = is_far ? q_ref[i] + (goal[i] - q_ref[i]) * farthest / way : goal[i];
  }
  void cut() {
    for (std::size_t i = 0; i < q_ref.size(); ++i) q_ref[i] = search_.limits.cut(i, q_ref[i]);
  }

  library::PoseSearch search_;
  bool stood_ = false;  // the flag was up in the last cycle
};

CHIMERA_COMPONENT(Ginvkin, "ginvkin", "Generalized inverse kinematics.", rate = 1000.0,
                  source = "2000 paper, table 1 and figure 3; Nakamura and Hanafusa 1986");

}  // namespace
