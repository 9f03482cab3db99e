// SPDX-License-Identifier: Apache-2.0
// For tests: compares kinematics of random arms and poses with Orocos KDL, an independent implementation.
#pragma once

#include <cstddef>
#include <string>

namespace chimera::library {

/// Counts of a run over seeds.
struct KdlTally {
  std::size_t poses = 0;     ///< tool frames and Jacobians of a serial arm
  std::size_t inverses = 0;  ///< solutions of the closed form that were checked by forward kinematics
  std::size_t searches = 0;  ///< poses given to the generic search
  std::size_t solved = 0;    ///< poses that it found
};

/// Returns the first difference for the arms of a seed, or "": 20 poses of a random arm of 1 to 10 joints, 20 of the
/// Puma in both directions, one search. Context: setup.
std::string judge_kinematics(unsigned seed, KdlTally& tally);

}  // namespace chimera::library
