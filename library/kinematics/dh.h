// SPDX-License-Identifier: Apache-2.0
// Constants by which a robot describes its geometry to generic kinematics (2000 paper, section 3.2). All components use
// these names:
//
//   ndof   int32                 joints
//   dh     DhLink[ndof<=10]      one row a joint, base to wrist, standard Denavit-Hartenberg
//   base   Pose                  frame 0 in the base frame; default: the same
//   tool   Pose                  the tool frame in frame ndof; default: the same
//
//   T(q) = base  prod_i  Rz(q_i + theta_i) Tz(d_i) Tx(a_i) Rx(alpha_i)  tool
//
// Every serial chain of turning joints has this form (library/kinematics/dh_of_axes.h computes it); base and tool hold
// what rows cannot express. The form therefore serves the Puma's table, a module store and a URDF file.
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

/// The identity.
inline constexpr Pose kIdentityPose{{0, 0, 0}, {1, 0, 0, 0}};

}  // namespace chimera::library

template <>
struct chimera::Fields<chimera::library::DhLink> {
  static constexpr const char* name = "DhLink";
  static constexpr auto list = std::tuple{
      field("a", "m", &library::DhLink::a), field("alpha", "rad", &library::DhLink::alpha),
      field("d", "m", &library::DhLink::d), field("theta", "rad", &library::DhLink::theta)};
};
