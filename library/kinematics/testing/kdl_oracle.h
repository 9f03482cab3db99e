// SPDX-License-Identifier: Apache-2.0
// Kinematics of Orocos KDL, an independent reference for tests and the bench.
#pragma once

#include <array>
#include <memory>
#include <span>

#include "library/kinematics/serial_arm.h"

namespace chimera::library {

/// One chain in KDL.
class KdlArm {
 public:
  explicit KdlArm(const DhChain& chain);
  ~KdlArm();

  /// Computes tool frame and Jacobian at `q` (rad, ndof numbers) by KDL's recursive solvers, which store the results.
  void solve(std::span<const double> q);
  /// Results of the last solve().
  Frame tool_frame(Jacobian& jacobian) const;

 private:
  struct Solvers;
  std::unique_ptr<Solvers> solvers_;
};

}  // namespace chimera::library
