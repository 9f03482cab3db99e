// SPDX-License-Identifier: Apache-2.0
// Common part of all interfaces of a simulated arm: publishing the state, and stopping.
#pragma once

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <string>

#include "chimera/base/result.h"
#include "chimera/task/component.h"

namespace chimera::library {

/// Base of a component that moves an arm. `Arm` has position(), velocity(), resume(), brake() and fault(). The
/// component adds the in-var of the command, cycle(), and init() and reinit(), which load the arm.
template <class Arm>
struct ArmBody {
  Out<double[]> q{"q", "rad", "[ndof<=10]", frame = "joint", doc = "Measured joint positions."};
  Out<double[]> qd{"qd", "rad/s", "[ndof<=10]", frame = "joint", doc = "Measured joint velocities."};
  Out<bool> held{"held", initial = false, safe_state, doc = "The arm stands: the flag is up, or it is off."};

  // An arm that replaces another continues from the published place of that arm, not from its start_pose. It starts at
  // the speed that is handed over; otherwise at rest, because an arm that goes off brakes. An arm whose place is the
  // published one continues from its present state.
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
  // The arm refused a step and kept its state. The brakes make that state safe.
  bool error() {
    off();
    return false;
  }
  bool clear() { return true; }

 protected:
  /// For init and reinit: throws the error of `result`.
  static void check(const Result<void>& result) {
    if (!result) throw std::runtime_error(std::string(result.error().message.view()));
  }
  /// For cycle, after a step. `moved`: the step succeeded. `holds_itself`: the arm had no command.
  Outcome after(bool moved, bool holds_itself) {
    if (!moved) return fault(arm_.fault());
    publish(holds_itself);
    return ok();
  }

  Arm arm_;

 private:
  static constexpr double kStanding = 0.01;  // rad/s; a slower joint counts as standing

  void publish(bool holds_itself) {
    std::ranges::copy(arm_.position(), q.begin());
    std::ranges::copy(arm_.velocity(), qd.begin());
    *held = holds_itself && std::ranges::all_of(qd, [](double speed) { return std::abs(speed) < kStanding; });
  }
};

}  // namespace chimera::library
