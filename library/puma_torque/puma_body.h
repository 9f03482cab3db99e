// SPDX-License-Identifier: Apache-2.0
// What the two interfaces of the simulated Puma 560 have in common: everything but the command and what they tell.
#pragma once

#include "library/mujoco/arm_body.h"
#include "library/puma_torque/puma_arm.h"

namespace chimera::library {

struct PumaBody : ArmBody<PumaArm> {
 protected:
  /// For reinit: what `load` reads, at rest in the same place.
  template <class Load>
  void restart(Load load) {
    PumaVector here;
    std::ranges::copy(arm_.position(), here.begin());
    load();
    check(arm_.place(here));
  }
};

}  // namespace chimera::library
