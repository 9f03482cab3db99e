// SPDX-License-Identifier: Apache-2.0
// The constants by which a robot tells generic kinematics how it is built (2000 paper, section 3.2), in the same
// words everywhere:
//
//   ndof   int32                 joints
//   dh     DhLink[ndof<=10]      one row a joint, base to wrist, standard Denavit-Hartenberg
//   base   Pose                  frame 0 in the base frame; default: the same
//   tool   Pose                  the tool frame in frame ndof; default: the same
//
//   T(q) = base  prod_i  Rz(q_i + theta_i) Tz(d_i) Tx(a_i) Rx(alpha_i)  tool
//
// Every serial chain of turning joints can be written so (library/kinematics/dh_of_axes.h does), with base and tool
// taking what rows alone cannot say. So this is the one form, for the Puma's table, a module store and a URDF file.
#pragma once

#include <tuple>

#include "chimera/task/geometry.h"

namespace chimera::library {

inline constexpr std::size_t kMostJoints = 10;  ///< the maximum of `ndof`

/// One joint and the link after it.
struct DhLink {
  double a;      ///< m, along the common normal
  double alpha;  ///< rad, twist about the common normal
  double d;      ///< m, along the axis of the joint
  double theta;  ///< rad, added to the joint's angle
};

/// A pose that changes nothing.
inline constexpr Pose kIdentityPose{{0, 0, 0}, {1, 0, 0, 0}};

}  // namespace chimera::library

template <>
struct chimera::Fields<chimera::library::DhLink> {
  static constexpr const char* name = "DhLink";
  static constexpr auto list = std::tuple{
      field("a", "m", &library::DhLink::a), field("alpha", "rad", &library::DhLink::alpha),
      field("d", "m", &library::DhLink::d), field("theta", "rad", &library::DhLink::theta)};
};
