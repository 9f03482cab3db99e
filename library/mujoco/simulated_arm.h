// SPDX-License-Identifier: Apache-2.0
// An arm of up to ten hinges from a MuJoCo model, with drives. The simulated robot interfaces move it. All vectors are
// in joint space, base to tip.
#pragma once

#include <memory>
#include <span>
#include <string>

#include "chimera/base/fixed.h"
#include "chimera/base/result.h"
#include "library/mujoco/arm_model.h"

struct mjModel_;
struct mjData_;
struct mjVFS_;

namespace chimera::library {

/// Kind of a command.
enum class ArmInterface { kPosition, kVelocity, kTorque };

/// The drives behind the position and velocity interfaces. They use the dynamics of the arm: torque = M(q) a + c(q, qd)
/// + g(q) with a = 2 w (v - qd) within the acceleration limit. v is the velocity command, or w/2 (q_r - q) within the
/// speed limit and within the speed that can be braked on the way. A small joint error decays as in a critically damped
/// spring of angular frequency w, and a large one without overshoot if the torque suffices. The error of a continuous
/// joint is the short way. The speed limits of the model count, too.
struct ArmDrives {
  double bandwidth = 100;  ///< w, rad/s, 1 to 200
  double speed_limit = 3;  ///< rad/s, of the position interface
  double acceleration_limit = 20;  ///< rad/s2
};

/// One simulated arm. Not copyable: owns the MuJoCo model and its state.
class SimulatedArm {
 public:
  /// Reads an MJCF or URDF file, or one of `files`, and sets all joints to zero. Only the limits of the model's motors
  /// are used. A collision mesh of a URDF file that cannot be used is left out, with a note()
  /// (library/mujoco/urdf_meshes.h). Refuses a missing or ill-formed file and what find_arm() refuses. Context: setup;
  /// may block.
  Result<void> load(const char* path, const char* tip = "", const mjVFS_* files = nullptr);

  /// Sets the arm to rest at `q` (rad, one for each joint). Refuses another number of joints, a position outside the
  /// joint limits or not finite. Context: setup.
  Result<void> place(std::span<const double> q);

  /// Continues from `q` (rad) at `qd` (rad/s), one of each for each joint. Returns false and keeps the state, with the
  /// reason in fault(), for another number of joints, a number that is not finite, or a position more than kOvershoot
  /// outside the joint limits. A moving arm may pass its limits a little. Context: cycle boundary; wait-free.
  bool resume(std::span<const double> q, std::span<const double> qd);

  /// Sets the drives. Context: setup.
  void set_drives(const ArmDrives& drives) noexcept { drives_ = drives; }
  /// Cuts the torque at `limit` (N.m) if that is above 0. Context: setup.
  void limit_torque(std::span<const double> limit) noexcept;
  /// Damping while the configuration is illegal (N.m.s/rad). Default: 20/s times the inertia at each joint at zero.
  void set_hold_damping(std::span<const double> damping) noexcept;

  /// Advances by `dt` seconds in equal sub-steps of at most 0.5 ms. `command` is rad, rad/s or N.m: a position is cut
  /// at the joint limits, a velocity falls before them, a torque is cut at the limits of the drives. Returns false and
  /// keeps the state, with the reason in fault(), for a command not finite or of another size, a dt not positive, or a
  /// simulation that diverged. Context: cycle; wait-free; O(dt).
  bool step(ArmInterface interface, std::span<const double> command, double dt);

  /// Advances without a command, while the configuration is illegal: the drives carry the weight and damp the motion,
  /// so the arm comes to rest nearby. Returns as step(). Context: cycle; wait-free; O(dt).
  bool step_locally_stable(double dt);

  /// Brakes: the joints stand still at once. Context: cycle; wait-free.
  void brake();

  std::size_t joints() const noexcept { return arm_.ndof; }
  /// Position (rad) and velocity (rad/s). Context: cycle; wait-free.
  std::span<const double> position() const noexcept { return {q_.data(), arm_.ndof}; }
  std::span<const double> velocity() const noexcept { return {qd_.data(), arm_.ndof}; }
  /// Limits and kinematic constants. Context: cycle; wait-free.
  const ArmModel& arm() const noexcept { return arm_; }

  /// A note for the user about the model file, in one line; empty without one. Context: setup.
  const std::string& note() const noexcept { return note_; }
  /// Reason for the last false return; empty before. Context: any.
  const char* fault() const noexcept { return fault_.c_str(); }

  /// The model and its state, for properties of one robot only. Context: setup.
  mjModel_* model() const noexcept { return model_.get(); }
  mjData_* state() const noexcept { return state_.get(); }

 private:
  static constexpr double kOvershoot = 0.5;  // rad; puma_torque at full torque passes its limits by 0.29

  struct ModelRelease { void operator()(mjModel_* model) const; };
  struct DataRelease { void operator()(mjData_* data) const; };
  struct Command {
    bool holds;
    ArmInterface interface;
    const double* values;
  };

  bool make_state();
  bool advance(double dt, const Command& command);
  bool sub_step(const Command& command);
  void drive(const Command& command);
  double acceleration(const Command& command, std::size_t joint) const;
  void look();
  void save();
  void restore();
  bool refuse(const char* why) noexcept;

  std::unique_ptr<mjModel_, ModelRelease> model_;
  std::unique_ptr<mjData_, DataRelease> state_;
  std::unique_ptr<double[]> wanted_, inertial_, saved_;  // one number a degree of freedom of the model; q then qd
  ArmModel arm_;
  ArmDrives drives_;
  ArmVector q_{}, qd_{}, hold_damping_{};
  double longest_sub_step_ = 0.5e-3;
  FixedString<120> fault_;
  std::string note_;
};

}  // namespace chimera::library
