// SPDX-License-Identifier: Apache-2.0
// Judges how a robot follows its reference, in variables that `--expect` compares.
#include <algorithm>
#include <cmath>

#include "chimera/task/component.h"
#include "library/signals/input.h"
#include "library/signals/short_way.h"

using namespace chimera;

namespace {

constexpr std::size_t kMostJoints = 10;

struct TrackingMonitor {
  In<double[]> q_ref{"q_ref", "rad", "[ndof<=10]", frame = "joint", doc = "Reference positions."};
  In<double[]> q{"q", "rad", "[ndof<=10]", frame = "joint", doc = "Measured positions."};
  Out<double> max_error{"max_error", "rad", initial = 0.0, doc = "Largest error of all joints since on."};
  Out<double> error_now{"error_now", "rad", initial = 0.0, doc = "Largest error of all joints now."};
  Out<double> moved{"moved", "rad", initial = 0.0,
                    doc = "Least way of all joints from their place at on, within the window."};
  InConst<std::int32_t> ndof{"ndof", "1", range(1, 10), doc = "Joints."};
  InConst<bool[]> is_continuous{"is_continuous", "1", "[ndof<=10]", initial = false,
                                doc = "The joint turns without end: errors and ways are the short way."};
  InConst<double> window{"window", "s", initial = 2.0, range(0, 3600), doc = "Time that counts for moved."};

  void on() {
    elapsed_ = 0;
    *max_error = *error_now = *moved = 0;
    for (std::size_t i = 0; i < q.size(); ++i) {
      from_[i] = q[i];
      farthest_[i] = 0;
    }
  }
  Outcome cycle(Cycle c) {
    elapsed_ += c.dt();
    double error = 0;
    for (std::size_t i = 0; i < q.size(); ++i) {
      if (!std::isfinite(q[i]) || !std::isfinite(q_ref[i])) return library::unfit("a position is not finite", q, q_ref);
      error = std::max(error, distance(i, q_ref[i], q[i]));
      if (elapsed_ <= *window + 1e-9) farthest_[i] = std::max(farthest_[i], distance(i, q[i], from_[i]));
    }
    *error_now = error;
    *max_error = std::max(*max_error, error);
    *moved = *std::min_element(farthest_, farthest_ + q.size());
    return ok();
  }
  bool error() { return true; }

 private:
  double distance(std::size_t i, double to, double from) const {
    return std::abs(library::short_way(to - from, is_continuous[i]));
  }

  double from_[kMostJoints] = {};
  double farthest_[kMostJoints] = {};
  double elapsed_ = 0;
};

CHIMERA_COMPONENT(TrackingMonitor, "tracking_monitor", "Judges how a robot follows its reference.", rate = 1000.0);

}  // namespace
