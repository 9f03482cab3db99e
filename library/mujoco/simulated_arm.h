// SPDX-License-Identifier: Apache-2.0
// An arm of up to ten hinges from a MuJoCo model, with drives: what the simulated robot interfaces move.
// All vectors are joint space, base to tip.
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

/// What a command of an arm is.
enum class ArmInterface { kPosition, kVelocity, kTorque };

/// The drives behind the position and the velocity interface. They know the arm: torque = M(q) a + c(q, qd) + g(q) with
/// a = 2 w (v - qd) within the acceleration limit. v is the velocity command, or w/2 (q_r - q) within the speed limit
/// and within what can be braked on the way: a small error of a joint decays as that of a critically damped spring of
/// angular frequency w, whatever the arm, and a large one without overshoot as long as the torque suffices.
struct ArmDrives {
  double bandwidth = 100;  ///< w, rad/s, 1 to 200
  double speed_limit = 3;  ///< rad/s, of the position interface
  double acceleration_limit = 20;  ///< rad/s2
};

/// One simulated arm. Not copyable: owns the MuJoCo model and its state.
class SimulatedArm {
 public:
  /// Reads an MJCF or URDF file, or one of `files`, and stands at zero. Motors of the model are not used but for their
  /// limits. A collision mesh of a URDF file that cannot be used is left out: note() says so
  /// (library/mujoco/urdf_meshes.h). Refuses a missing or ill-formed file and what find_arm() refuses. Context: setup;
  /// may block.
  Result<void> load(const char* path, const char* tip = "", const mjVFS_* files = nullptr);

  /// Stands at rest in `q` (rad, one a joint). Refuses another number of joints, a position outside the joint limits or
  /// not finite. Context: setup.
  Result<void> place(std::span<const double> q);

  /// Goes on from `q` (rad) at `qd` (rad/s), one of each a joint. False, with fault() saying why and the state as
  /// before: another number of joints, what is not finite, or a position farther than kOvershoot outside the joint
  /// limits, which a moving arm may pass a little. Context: cycle boundary; wait-free.
  bool resume(std::span<const double> q, std::span<const double> qd);

  /// The drives from now on. Context: setup.
  void set_drives(const ArmDrives& drives) noexcept { drives_ = drives; }
  /// Cuts the torque at `limit` (N.m) where that is above 0. Context: setup.
  void limit_torque(std::span<const double> limit) noexcept;
  /// Damping while the configuration is illegal (N.m.s/rad); by itself 20/s times the inertia at each joint at zero.
  void set_hold_damping(std::span<const double> damping) noexcept;

  /// Moves on by `dt` seconds in equal sub-steps of at most 0.5 ms. `command` is rad, rad/s or N.m; a position is cut
  /// at the joint limits, a velocity slows down before them, a torque is cut at the limits of the drives.
  /// False, with fault() saying why and the state as before: command not finite or of another size, dt not positive, or
  /// a state that blew up. Context: cycle; wait-free; O(dt).
  bool step(ArmInterface interface, std::span<const double> command, double dt);

  /// Like step() without any command: the drives carry the weight and damp what moves, so the arm comes to rest near
  /// where it is. For the time of an illegal configuration. Context: cycle; wait-free; O(dt).
  bool step_locally_stable(double dt);

  /// Brakes on: the joints stand still at once. Context: cycle; wait-free.
  void brake();

  std::size_t joints() const noexcept { return arm_.ndof; }
  /// Position (rad) and velocity (rad/s). Context: cycle; wait-free.
  std::span<const double> position() const noexcept { return {q_.data(), arm_.ndof}; }
  std::span<const double> velocity() const noexcept { return {qd_.data(), arm_.ndof}; }
  /// Limits and kinematic constants. Context: cycle; wait-free.
  const ArmModel& arm() const noexcept { return arm_; }

  /// What whoever named the file should know of it, in one line; empty: nothing. Context: setup.
  const std::string& note() const noexcept { return note_; }
  /// Why the last call that answered false did; empty before. Context: any.
  const char* fault() const noexcept { return fault_.c_str(); }

  /// The model and its state, for what one robot has and others have not. Context: setup.
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
