// SPDX-License-Identifier: Apache-2.0
// What Orocos KDL says of a chain: a reference that nobody here wrote, for tests.
#pragma once

#include <array>
#include <vector>

#include "library/kinematics/serial_arm.h"

namespace chimera::library {

/// One pose of a chain.
struct ArmPose {
  std::array<double, kMostJoints> q{};
  Frame tool;
  Jacobian jacobian;
};

/// Fills in `tool` and `jacobian` of each pose as KDL computes them. `base` and `tool` of the chain are left out.
void ask_kdl(const DhChain& chain, std::vector<ArmPose>& poses);

}  // namespace chimera::library
