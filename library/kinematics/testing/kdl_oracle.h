// SPDX-License-Identifier: Apache-2.0
// What Orocos KDL says of a chain: a reference that nobody here wrote, for tests and the bench.
#pragma once

#include <array>
#include <memory>
#include <span>

#include "library/kinematics/serial_arm.h"

namespace chimera::library {

/// One chain in KDL's hands.
class KdlArm {
 public:
  explicit KdlArm(const DhChain& chain);
  ~KdlArm();

  /// Forward kinematics and Jacobian at `q` (rad, ndof of them) by KDL's recursive solvers, which keep the answer.
  void solve(std::span<const double> q);
  /// The answer of the last solve().
  Frame tool_frame(Jacobian& jacobian) const;

 private:
  struct Solvers;
  std::unique_ptr<Solvers> solvers_;
};

}  // namespace chimera::library
