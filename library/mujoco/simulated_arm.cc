// SPDX-License-Identifier: Apache-2.0
// Integrates a simulated arm with its drives in sub-steps of at most 0.5 ms.
#include "library/mujoco/simulated_arm.h"

#include <mujoco/mujoco.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <fstream>
#include <optional>

#include "chimera/base/hosted/ordinary_file.h"
#include "library/mujoco/model_file.h"
#include "library/model_text/model_numbers.h"
#include "library/mujoco/mujoco_guard.h"
#include "library/mujoco/refusal.h"
#include "library/signals/short_way.h"

namespace chimera::library {
namespace {

// Euler's method, implicit in the viscous friction as MuJoCo does it, is stable for any friction. RK4 costs four times
// as much.
constexpr double kLongestSubStep = 0.5e-3;
constexpr double kHoldRate = 20;  // 1/s, damping of the motion while the configuration is illegal

bool within(double value, double low, double high) { return value >= low && value <= high; }

const char* has_blown_up() {
  return mujoco_error()[0] != '\0' ? mujoco_error() : "the simulated arm blew up: its state is not a number";
}

/// Judges the text of the file, and reads the arm if it is a URDF file: some texts would end the process in MuJoCo.
Result<void> read_before_mujoco(const char* path, const char* tip, std::optional<UrdfChain>& urdf) {
  constexpr std::size_t kHead = std::size_t{16} << 20;  // as check_model_numbers()
  const Result<std::string> head = read_ordinary(path, kHead);
  if (!head || !is_urdf(*head)) return check_model_numbers(path);
  Result<UrdfChain> chain = read_urdf(path, tip);
  if (!chain) return chain.error();
  urdf = *chain;
  return {};
}

}  // namespace

void SimulatedArm::ModelRelease::operator()(mjModel_* model) const { mj_deleteModel(model); }
void SimulatedArm::DataRelease::operator()(mjData_* data) const { mj_deleteData(data); }

Result<void> SimulatedArm::load(const char* path, const char* tip, const mjVFS_* files) {
  install_mujoco_handlers();
  if (const std::string unfit = files == nullptr ? not_ordinary(path, SIZE_MAX) : ""; !unfit.empty())
    return refusal("%s: %s", path, unfit.c_str());
  if (files == nullptr && std::ifstream(path).peek() == std::ifstream::traits_type::eof()) {
    return refusal("%s: cannot be read, or there is nothing in it", path);
  }
  std::optional<UrdfChain> urdf;
  if (files == nullptr) {
    if (Result<void> read = read_before_mujoco(path, tip, urdf); !read) return read;
  }
  std::string why;
  state_.reset();
  note_.clear();
  model_.reset(files == nullptr ? load_model(path, why, note_) : load_model(path, *files, why));
  if (!model_) return refusal("%s: %.300s", path, why.c_str());
  mjModel* m = model_.get();
  m->opt.disableflags |= mjDSBL_ACTUATION;
  longest_sub_step_ = m->opt.timestep > 0 ? std::min(m->opt.timestep, kLongestSubStep) : kLongestSubStep;
  if (!make_state()) return refusal("%s: %.300s", path, mujoco_error());
  const Result<ArmModel> arm = urdf ? find_arm(m, state_.get(), *urdf) : find_arm(m, state_.get(), tip);
  if (!arm) return refusal("%s: %s", path, arm.error().message.c_str());
  if (urdf && !urdf->note.empty()) note_ = urdf->note + (note_.empty() ? "" : "; ") + note_;
  arm_ = *arm;
  const auto numbers = static_cast<std::size_t>(m->nv);
  wanted_ = std::make_unique<double[]>(numbers);
  inertial_ = std::make_unique<double[]>(numbers);
  saved_ = std::make_unique<double[]>(numbers + static_cast<std::size_t>(m->nq));
  if (!guarded(mj_forward, m, state_.get())) return refusal("%s: %s", path, has_blown_up());
  for (std::size_t i = 0; i < arm_.ndof; ++i) {
    hold_damping_[i] = kHoldRate * state_->qM[m->dof_Madr[arm_.dof[i]]];
  }
  look();
  return {};
}

bool SimulatedArm::make_state() {
  const auto make = [](void* with) {
    SimulatedArm& arm = *static_cast<SimulatedArm*>(with);
    arm.state_.reset(mj_makeData(arm.model_.get()));
  };
  return guarded_setup(make, this) && state_ != nullptr;
}

void SimulatedArm::limit_torque(std::span<const double> limit) noexcept {
  for (std::size_t i = 0; i < std::min(limit.size(), arm_.ndof); ++i) {
    if (limit[i] > 0) arm_.torque_limit[i] = limit[i];
  }
}

void SimulatedArm::set_hold_damping(std::span<const double> damping) noexcept {
  std::copy_n(damping.begin(), std::min(damping.size(), arm_.ndof), hold_damping_.begin());
}

Result<void> SimulatedArm::place(std::span<const double> q) {
  if (q.size() != arm_.ndof) return refusal("a pose of %zu joints, but the arm has %zu", q.size(), arm_.ndof);
  for (std::size_t i = 0; i < arm_.ndof; ++i) {
    if (!within(q[i], arm_.low[i], arm_.high[i])) {
      return refusal("joint %zu at %.4g rad is outside its limits %.4g to %.4g rad", i + 1, q[i], arm_.low[i],
                 arm_.high[i]);
    }
  }
  mj_resetData(model_.get(), state_.get());
  for (std::size_t i = 0; i < arm_.ndof; ++i) state_->qpos[arm_.position[i]] = q[i];
  if (!guarded(mj_forward, model_.get(), state_.get())) return refusal("at start_pose: %s", has_blown_up());
  look();
  return {};
}

bool SimulatedArm::resume(std::span<const double> q, std::span<const double> qd) {
  char text[120];
  if (q.size() != arm_.ndof || qd.size() != arm_.ndof) {
    std::snprintf(text, sizeof text, "a motion of %zu joints to go on from, but the arm has %zu", q.size(), arm_.ndof);
    return refuse(text);
  }
  for (std::size_t i = 0; i < arm_.ndof; ++i) {
    if (within(q[i], arm_.low[i] - kOvershoot, arm_.high[i] + kOvershoot) && std::isfinite(qd[i])) continue;
    std::snprintf(text, sizeof text, "joint %zu cannot go on at %.4g rad, %.4g rad/s: it moves from %.4g to %.4g rad",
                  i + 1, q[i], qd[i], arm_.low[i], arm_.high[i]);
    return refuse(text);
  }
  save();
  for (std::size_t i = 0; i < arm_.ndof; ++i) {
    state_->qpos[arm_.position[i]] = q[i];
    state_->qvel[arm_.dof[i]] = qd[i];
  }
  if (!guarded(mj_forward, model_.get(), state_.get())) {
    restore();
    return refuse(mujoco_error()[0] != '\0' ? mujoco_error() : "the simulated arm cannot go on from there");
  }
  look();
  return true;
}

bool SimulatedArm::refuse(const char* why) noexcept {
  fault_.assign(why);
  return false;
}

void SimulatedArm::look() {
  for (std::size_t i = 0; i < arm_.ndof; ++i) {
    q_[i] = state_->qpos[arm_.position[i]];
    qd_[i] = state_->qvel[arm_.dof[i]];
  }
}

void SimulatedArm::save() {
  mju_copy(saved_.get(), state_->qpos, model_->nq);
  mju_copy(saved_.get() + model_->nq, state_->qvel, model_->nv);
}

void SimulatedArm::restore() {
  mju_copy(state_->qpos, saved_.get(), model_->nq);
  mju_copy(state_->qvel, saved_.get() + model_->nq, model_->nv);
}

double SimulatedArm::acceleration(const Command& command, std::size_t i) const {
  const double w = drives_.bandwidth, most = drives_.acceleration_limit;
  double v = command.values[i];
  if (command.interface == ArmInterface::kPosition) {
    const double error = library::short_way(std::clamp(v, arm_.low[i], arm_.high[i]) - q_[i], arm_.is_continuous[i]);
    const double top = std::min(drives_.speed_limit, arm_.speed_limit[i]);
    const double fastest = std::min(top, std::sqrt(most * std::abs(error)));
    v = std::clamp(0.5 * w * error, -fastest, fastest);
  } else {
    const auto fastest = [&](double way) { return std::min(0.25 * w * way, std::sqrt(most * way)); };
    const double down = std::max(q_[i] - arm_.low[i], 0.0), up = std::max(arm_.high[i] - q_[i], 0.0);
    const double top = arm_.speed_limit[i];
    v = std::clamp(v, -std::min(fastest(down), top), std::min(fastest(up), top));
  }
  return std::clamp(2 * w * (v - qd_[i]), -most, most);
}

void SimulatedArm::drive(const Command& command) {
  const mjModel* m = model_.get();
  mjData* d = state_.get();
  look();
  const bool computes = !command.holds && command.interface != ArmInterface::kTorque;
  if (computes) {
    for (std::size_t i = 0; i < arm_.ndof; ++i) {
      wanted_[static_cast<std::size_t>(arm_.dof[i])] = acceleration(command, i);
    }
    mj_mulM(m, d, inertial_.get(), wanted_.get());
  }
  for (std::size_t i = 0; i < arm_.ndof; ++i) {
    const int at = arm_.dof[i];
    double torque = 0;
    if (command.holds) torque = d->qfrc_bias[at] - hold_damping_[i] * d->qvel[at];
    else if (computes) torque = inertial_[static_cast<std::size_t>(at)] + d->qfrc_bias[at] - d->qfrc_passive[at];
    else torque = command.values[i];
    d->qfrc_applied[at] = std::clamp(torque, -arm_.torque_limit[i], arm_.torque_limit[i]);
  }
}

bool SimulatedArm::sub_step(const Command& command) {
  if (!guarded(mj_step1, model_.get(), state_.get())) return false;
  drive(command);
  return guarded(mj_step2, model_.get(), state_.get());
}

bool SimulatedArm::advance(double dt, const Command& command) {
  if (!(dt > 0) || !std::isfinite(dt)) return refuse("the time step is not positive");
  save();
  const double n = std::ceil(dt / longest_sub_step_ - 1e-9);
  model_->opt.timestep = dt / n;
  for (double i = 0; i < n; ++i) {
    if (sub_step(command)) continue;
    restore();
    look();
    return refuse(has_blown_up());
  }
  look();
  return true;
}

bool SimulatedArm::step(ArmInterface interface, std::span<const double> command, double dt) {
  static constexpr const char* kNames[] = {"q_ref", "qd_ref", "tau"};
  const char* name = kNames[static_cast<int>(interface)];
  char text[120];
  if (command.size() != arm_.ndof) {
    std::snprintf(text, sizeof text, "%s has %zu elements, but the arm %zu joints", name, command.size(), arm_.ndof);
    return refuse(text);
  }
  for (std::size_t i = 0; i < command.size(); ++i) {
    if (std::isfinite(command[i])) continue;
    std::snprintf(text, sizeof text, "%s[%zu] is not finite", name, i);
    return refuse(text);
  }
  return advance(dt, {false, interface, command.data()});
}

bool SimulatedArm::step_locally_stable(double dt) { return advance(dt, {true, ArmInterface::kTorque, nullptr}); }

void SimulatedArm::brake() {
  for (std::size_t i = 0; i < arm_.ndof; ++i) state_->qvel[arm_.dof[i]] = 0;
  look();
}

}  // namespace chimera::library
