// SPDX-License-Identifier: Apache-2.0
// Links, joints and limits of a URDF file. urdf_model and the simulated robots read them here, so one file means one
// thing, and MuJoCo sees no file that it cannot bear.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "chimera/base/result.h"
#include "library/kinematics/frame.h"

namespace chimera::library {

inline constexpr double kNoModelLimit = 1e6;  ///< rad, rad/s or N.m (m, m/s, N): the file states no limit

enum class UrdfKind : std::uint8_t { kFixed, kRevolute, kContinuous, kPrismatic, kPlanar, kFloating };

struct UrdfJoint {
  std::string name, parent, child;  ///< the last two are links
  UrdfKind kind = UrdfKind::kFixed;
  Frame origin;       ///< of the child link in the parent link, at zero
  Vec3 axis{1, 0, 0};  ///< in the child link
  double low = -kNoModelLimit, high = kNoModelLimit;
  double speed = kNoModelLimit, effort = kNoModelLimit;
  std::string mimics;  ///< name of the joint that this one follows; empty: none

  bool turns() const noexcept { return kind == UrdfKind::kRevolute || kind == UrdfKind::kContinuous; }
};

struct UrdfText {
  std::vector<std::string> links;  ///< by name
  std::vector<UrdfJoint> joints;   ///< in the order of the file
  std::string note;                ///< what the text states and this program ignores, in one line; empty: nothing

  bool has_link(std::string_view name) const noexcept;
  /// The joint that carries `link`; nullptr for the root and for an unknown link.
  const UrdfJoint* joint_before(std::string_view link) const noexcept;
};

/// True if the first element is <robot>, in any letters, as MuJoCo judges it. Context: setup.
bool is_urdf(std::string_view text);

/// Refuses ill-formed XML, an element that is missing, repeated or without its attributes, a joint of an unknown type,
/// a joint that turns or slides without a range, limits out of order, an axis without a direction, unknown links and
/// joints, two parents, more than one root, a circle, more than 1000 links. Context: setup.
Result<UrdfText> read_urdf_text(std::string_view text);

}  // namespace chimera::library
