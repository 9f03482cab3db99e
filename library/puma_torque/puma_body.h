// SPDX-License-Identifier: Apache-2.0
// What the two interfaces of the simulated Puma 560 have in common: everything but the command and what they tell.
#pragma once

#include <algorithm>
#include <stdexcept>
#include <string>

#include "chimera/task/component.h"
#include "library/puma_torque/puma_arm.h"

namespace chimera::library {

/// The ports and methods of the arm that a component derives from. It adds the in-var of the command and cycle(), and
/// init() and reinit() with what it loads.
struct PumaBody {
  Out<double[]> q{"q", "rad", "[ndof<=10]", frame = "joint", doc = "Measured joint positions."};
  Out<double[]> qd{"qd", "rad/s", "[ndof<=10]", frame = "joint", doc = "Measured joint velocities."};

  void on() { publish(); }
  void off() {
    arm_.brake();
    publish();
  }
  // The arm refused a step and stands as before it: with the brakes on it is in a sound state again.
  bool error() {
    off();
    return false;
  }
  bool clear() { return true; }

 protected:
  /// For init: throws what `result` refuses.
  static void check(const Result<void>& result) {
    if (!result) throw std::runtime_error(std::string(result.error().message.view()));
  }
  /// For reinit: what `load` reads, at rest in the same place.
  template <class Load>
  void restart(Load load) {
    PumaVector here;
    std::ranges::copy(arm_.position(), here.begin());
    load();
    check(arm_.place(here));
  }
  /// For cycle: what becomes of a step that has `moved` the arm, or has not.
  Outcome after(bool moved) {
    if (!moved) return fault(arm_.fault());
    publish();
    return ok();
  }

  PumaArm arm_;

 private:
  void publish() {
    std::ranges::copy(arm_.position(), q.begin());
    std::ranges::copy(arm_.velocity(), qd.begin());
  }
};

}  // namespace chimera::library
