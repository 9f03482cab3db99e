// SPDX-License-Identifier: Apache-2.0
// What a URDF file says of the serial chain from its root to a tip.
#pragma once

#include <array>
#include <string>

#include "chimera/base/result.h"
#include "library/kinematics/dh_of_axes.h"

namespace chimera::library {

/// The joints of the chain that turn, root to tip.
struct UrdfChain {
  DhChain chain;
  std::array<std::string, kMostJoints> joints;
  std::array<double, kMostJoints> low{}, high{};  ///< rad; -1e6 and 1e6 for a continuous joint
  std::array<double, kMostJoints> speed{};        ///< rad/s; 1e6 where the file states no limit
  std::array<double, kMostJoints> effort{};       ///< N.m; 1e6 where the file states no limit
};

/// Reads `path` from the root to the link `tip`; an empty text stands for the link behind the most turning joints, the
/// first of that many by name. Refuses a file that is missing or no URDF, an unknown tip, a joint on the way that
/// slides, floats or mimics another, no turning joint, more than kMostJoints. Context: setup; may block.
Result<UrdfChain> read_urdf(const std::string& path, const std::string& tip);

}  // namespace chimera::library
