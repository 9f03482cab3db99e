// SPDX-License-Identifier: Apache-2.0
// Common part of the two interfaces of the simulated Puma 560: everything except command and constants.
#pragma once

#include "library/mujoco/arm_body.h"
#include "library/puma_torque/puma_arm.h"

namespace chimera::library {

struct PumaBody : ArmBody<PumaArm> {
 protected:
  /// For reinit: loads the arm again and keeps the place, at rest.
  template <class Load>
  void restart(Load load) {
    PumaVector here;
    std::ranges::copy(arm_.position(), here.begin());
    load();
    check(arm_.place(here));
  }
};

}  // namespace chimera::library
