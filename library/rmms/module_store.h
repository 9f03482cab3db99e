// SPDX-License-Identifier: Apache-2.0
// Reads the modules of a reconfigurable arm from a text file, in place of their EPROMs. One line for each joint module
// and the link after it, base to tip; `#` begins a comment:
//
//   # module     a m   alpha deg   d m   theta deg   mass kg   low deg   high deg   torque N.m
//   rotate-1     0     90          0.35  0           9.0       -170      170        270
#pragma once

#include <array>
#include <string>

#include "chimera/base/result.h"
#include "library/kinematics/dh.h"

namespace chimera::library {

/// One joint module with the link after it.
struct RmmsModule {
  std::string name;
  DhLink link{};
  double mass = 0;           ///< kg, spread along the link
  double low = 0, high = 0;  ///< rad
  double torque = 0;         ///< N.m, in both directions
};

/// The modules of an arm, base to tip.
struct ModuleStore {
  std::array<RmmsModule, kMostJoints> modules;
  std::size_t count = 0;

  /// Reads a store. Refuses, with the line number: a file that cannot be read, a line without a name and eight finite
  /// numbers, a mass or torque that is not positive, limits out of order, a module without length or with excessive
  /// numbers, no module, more than kMostJoints, a line or a file that is too long. Context: setup; may block.
  static Result<ModuleStore> read(const std::string& path);
  /// The arm as MJCF, with a site `tip`.
  std::string mjcf() const;
};

}  // namespace chimera::library
