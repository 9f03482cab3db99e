// SPDX-License-Identifier: Apache-2.0
// The mechanics of a torque-driven Puma 560 on MuJoCo, for the component puma_torque. All vectors are in joint space,
// base to wrist; positions are standard Denavit-Hartenberg angles.
#pragma once

#include <array>
#include <span>

#include "chimera/base/result.h"
#include "library/mujoco/link_masses.h"
#include "library/mujoco/simulated_arm.h"

namespace chimera::library {

inline constexpr std::size_t kPumaJoints = 6;
inline constexpr char kPumaModel[] = "puma560.xml";  ///< the built-in model
using PumaVector = std::array<double, kPumaJoints>;  ///< rad, rad/s or N.m
using PumaInput = std::span<const double, kPumaJoints>;

/// Properties that differ from arm to arm.
struct PumaSettings {
  double payload_mass = 0;   ///< kg, 0 to 10: a ball of radius 50 mm centred on the flange
  double coulomb_share = 0;  ///< share of the published Coulomb friction, 0 to 1
};

/// One simulated Puma. Not copyable: owns the MuJoCo model and its state.
class PumaArm {
 public:
  /// Reads the model and sets all joints to zero. "puma560.xml" without a directory is the model built into this
  /// object, even if the working directory has a file of that name. Refuses a missing or ill-formed file, a model that
  /// is not a six-joint arm with its names, a payload outside 0..10 kg, a share outside 0..1. Context: setup; may
  /// block.
  Result<void> load(const char* mjcf_path, const PumaSettings& settings);

  /// Sets the arm to rest at `q` (rad). Refuses a position outside the joint limits or not finite. Context: setup.
  Result<void> place(PumaInput q);

  /// Advances by `dt` seconds in equal sub-steps of at most 0.5 ms with `torque` (N.m, cut at the limits of the
  /// drives). Returns false and keeps the state, with the reason in fault(), for a torque not finite, a dt not
  /// positive, or a simulation that diverged. Context: cycle; wait-free; O(dt).
  bool step(PumaInput torque, double dt);

  /// Advances with a command of any kind: rad, rad/s or N.m. Context: cycle; wait-free; O(dt).
  bool step(ArmInterface interface, PumaInput command, double dt) { return arm_.step(interface, command, dt); }
  /// Sets the drives of the position and velocity interfaces. Context: setup.
  void set_drives(const ArmDrives& drives) noexcept { arm_.set_drives(drives); }

  /// Advances without a command, while the configuration is illegal: the drives carry the weight and damp the motion,
  /// so the arm comes to rest nearby. Context: cycle; wait-free; O(dt).
  bool step_locally_stable(double dt);

  /// Continues from a position (rad) and velocity (rad/s): see SimulatedArm. Context: cycle boundary; wait-free.
  bool resume(std::span<const double> q, std::span<const double> qd) { return arm_.resume(q, qd); }

  /// Brakes: the joints stand still at once. Context: cycle; wait-free.
  void brake();

  /// Position (rad), velocity (rad/s), torque limits of the drives (N.m). Context: cycle; wait-free.
  PumaInput position() const noexcept;
  PumaInput velocity() const noexcept;
  const PumaVector& torque_limit() const noexcept { return torque_limit_; }
  /// Geometry of the arm, base to flange, and mass properties of its links without payload. Context: setup.
  const DhChain& chain() const noexcept { return arm_.arm().chain; }
  const std::array<LinkMass, kMostJoints>& links() const noexcept { return links_; }
  const ArmVector& lower_limit() const noexcept { return arm_.arm().low; }
  const ArmVector& upper_limit() const noexcept { return arm_.arm().high; }

  /// The simulated arm, with its MuJoCo model and state. Context: setup.
  const SimulatedArm& simulation() const noexcept { return arm_; }

  /// Reason for the last false return; empty before. Context: any.
  const char* fault() const noexcept { return arm_.fault(); }

 private:
  Result<void> read_model(const char* mjcf_path);
  void apply(const PumaSettings& settings);

  SimulatedArm arm_;
  PumaVector torque_limit_{};
  std::array<LinkMass, kMostJoints> links_{};
};

}  // namespace chimera::library
