// SPDX-License-Identifier: Apache-2.0
// For tests: our kinematics of a seed's arms and poses against Orocos KDL, a reference that nobody here wrote.
#pragma once

#include <cstddef>
#include <string>

namespace chimera::library {

/// What a run of seeds has seen.
struct KdlTally {
  std::size_t poses = 0;     ///< tool frames and Jacobians of a serial arm
  std::size_t inverses = 0;  ///< solutions of the closed form that were led back
  std::size_t searches = 0;  ///< poses the generic search was asked for
  std::size_t solved = 0;    ///< ... and found
};

/// Says what differs for an arm of that seed, or "": 20 poses of a random arm of 1 to 10 joints, 20 of the Puma in both
/// directions, one search. Context: setup.
std::string judge_kinematics(unsigned seed, KdlTally& tally);

}  // namespace chimera::library
