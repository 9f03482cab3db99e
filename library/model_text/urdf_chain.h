// SPDX-License-Identifier: Apache-2.0
// Reads the serial chain of a URDF file from its root to a tip.
#pragma once

#include <array>
#include <string>

#include "chimera/base/result.h"
#include "library/kinematics/dh_of_axes.h"
#include "library/model_text/urdf_text.h"

namespace chimera::library {

/// The turning joints of the chain, root to tip.
struct UrdfChain {
  DhChain chain;
  std::array<std::string, kMostJoints> joints;
  std::array<JointAxis, kMostJoints> axes{};      ///< in the root link, at zero
  std::array<double, kMostJoints> low{}, high{};  ///< rad; -1e6 and 1e6 for a continuous joint
  std::array<double, kMostJoints> speed{};        ///< rad/s; 1e6 without a limit
  std::array<double, kMostJoints> effort{};       ///< N.m; 1e6 without a limit
  std::array<bool, kMostJoints> is_continuous{};
  std::string tip;   ///< its link
  std::string note;  ///< as in UrdfText
};

/// Reads `path` from the root to the link `tip`. An empty text means the link behind the most turning joints; of
/// several the one behind the most fixed joints, then the first by name. Refuses what check_model_numbers() and
/// read_urdf_text() refuse, a file that is missing or longer than 4 MiB, an unknown tip, a joint on the way that
/// slides, floats or mimics another, no turning joint, more than kMostJoints. Context: setup; may block.
Result<UrdfChain> read_urdf(const std::string& path, const std::string& tip);

}  // namespace chimera::library
