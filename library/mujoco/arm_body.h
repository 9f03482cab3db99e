// SPDX-License-Identifier: Apache-2.0
// What every interface of a simulated arm has: where the arm is, and how it stops.
#pragma once

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <string>

#include "chimera/base/result.h"
#include "chimera/task/component.h"

namespace chimera::library {

/// The ports and methods of an arm that a component derives from. `Arm` has position(), velocity(), resume(), brake()
/// and fault(). What derives from it adds the in-var of the command and cycle(), and init() and reinit() with where
/// the arm comes from.
template <class Arm>
struct ArmBody {
  Out<double[]> q{"q", "rad", "[ndof<=10]", frame = "joint", doc = "Measured joint positions."};
  Out<double[]> qd{"qd", "rad/s", "[ndof<=10]", frame = "joint", doc = "Measured joint velocities."};
  Out<bool> held{"held", initial = false, safe_state, doc = "The arm stands: the flag is up, or it is off."};

  // A simulated arm that takes the place of another goes on where that one is, whatever its own start_pose says: at the
  // speed that is handed over, else at rest, for an arm that goes off brakes. One that stands where its out-vars say is
  // in its own place: it goes on from its present state.
  Outcome on() {
    if (q.inherited() != kNever && !std::ranges::equal(q, arm_.position())) {
      for (double& speed : qd)
        if (!qd.is_handed_over()) speed = 0;
      if (!arm_.resume({q.begin(), q.size()}, {qd.begin(), qd.size()})) return fault(arm_.fault());
    }
    publish(false);
    return ok();
  }
  void off() {
    arm_.brake();
    publish(true);
  }
  // The arm refused a step and stands as before it: with the brakes on it is in a sound state again.
  bool error() {
    off();
    return false;
  }
  bool clear() { return true; }

 protected:
  /// For init and reinit: throws what `result` refuses.
  static void check(const Result<void>& result) {
    if (!result) throw std::runtime_error(std::string(result.error().message.view()));
  }
  /// For cycle: what becomes of a step that has `moved` the arm, or has not, with a command or by itself.
  Outcome after(bool moved, bool holds_itself) {
    if (!moved) return fault(arm_.fault());
    publish(holds_itself);
    return ok();
  }

  Arm arm_;

 private:
  static constexpr double kStanding = 0.01;  // rad/s: slower than that a joint stands

  void publish(bool holds_itself) {
    std::ranges::copy(arm_.position(), q.begin());
    std::ranges::copy(arm_.velocity(), qd.begin());
    *held = holds_itself && std::ranges::all_of(qd, [](double speed) { return std::abs(speed) < kStanding; });
  }
};

}  // namespace chimera::library
