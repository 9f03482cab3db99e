// SPDX-License-Identifier: Apache-2.0
#include "library/puma_torque/puma_arm.h"

#include <mujoco/mujoco.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstring>

#include "library/puma_torque/mujoco_guard.h"
#include "puma560_mjcf.h"

namespace chimera::library {
namespace {

// Euler's method, implicit in the viscous friction as MuJoCo does it, is stable for any friction; the motor
// inertias (0.17 kg.m2 and more) leave only controllers faster than 2/(0.5 ms) to upset it. RK4 costs four times as
// much.
constexpr double kLongestSubStep = 0.5e-3;

// Damping of the drives while the configuration is illegal (N.m.s/rad): 20/s times each joint's inertia or so.
constexpr PumaVector kHoldDamping{80, 80, 20, 4, 4, 4};
constexpr double kPayloadRadius = 0.05;

template <class... Values>
Error bad(const char* format, Values... values) {
  Error error;
  char text[400];
  std::snprintf(text, sizeof text, format, values...);
  error.message = FixedString<400>(text);
  return error;
}

struct FilesRelease {
  void operator()(mjVFS* files) const {
    mj_deleteVFS(files);
    delete files;
  }
};

// A component runs from a sealed copy of its object: it cannot know what lies beside the file it came from.
std::unique_ptr<mjVFS, FilesRelease> built_in_files() {
  std::unique_ptr<mjVFS, FilesRelease> files(new mjVFS);
  mj_defaultVFS(files.get());
  mj_makeEmptyFileVFS(files.get(), kPumaModel, sizeof kPumaMjcf - 1);
  std::memcpy(files->filedata[0], kPumaMjcf, sizeof kPumaMjcf - 1);
  return files;
}

bool within(double value, double low, double high) { return value >= low && value <= high; }

}  // namespace

void PumaArm::ModelRelease::operator()(mjModel_* model) const { mj_deleteModel(model); }
void PumaArm::DataRelease::operator()(mjData_* data) const { mj_deleteData(data); }

PumaArm::PumaArm() noexcept = default;
PumaArm::~PumaArm() = default;

Result<void> PumaArm::read_model(const char* mjcf_path) {
  install_mujoco_handlers();
  char why[1000] = "";
  const bool built_in = std::strcmp(mjcf_path, kPumaModel) == 0;
  const std::unique_ptr<mjVFS, FilesRelease> files = built_in ? built_in_files() : nullptr;
  model_.reset(mj_loadXML(mjcf_path, files.get(), why, sizeof why));
  if (!model_) return bad("%s: %.300s", mjcf_path, why);
  if (model_->nq != 6 || model_->nv != 6 || model_->nu != 6) {
    return bad("%s: found %d joints and %d motors, expected 6 and 6", mjcf_path, static_cast<int>(model_->nv),
               static_cast<int>(model_->nu));
  }
  for (const char* body : {"link3", "link6", "payload"}) {
    if (mj_name2id(model_.get(), mjOBJ_BODY, body) < 0) return bad("%s: there is no body '%s'", mjcf_path, body);
  }
  const int inertia = mj_name2id(model_.get(), mjOBJ_NUMERIC, "link3_inertia");
  if (inertia < 0 || model_->numeric_size[inertia] != 3) {
    return bad("%s: expected three numbers 'link3_inertia' under <custom>", mjcf_path);
  }
  return {};
}

Result<void> PumaArm::load(const char* mjcf_path, const PumaSettings& settings) {
  if (!within(settings.payload_mass, 0, 10)) {
    return bad("payload_mass is %g kg, expected 0 to 10 kg", settings.payload_mass);
  }
  if (!within(settings.coulomb_share, 0, 1)) return bad("coulomb_share is %g, expected 0 to 1", settings.coulomb_share);
  state_.reset();
  if (Result<void> read = read_model(mjcf_path); !read) {
    model_.reset();
    return read;
  }
  state_.reset(mj_makeData(model_.get()));
  apply(settings);
  return place(PumaVector{});
}

void PumaArm::apply(const PumaSettings& settings) {
  mjModel* m = model_.get();
  const int link3 = mj_name2id(m, mjOBJ_BODY, "link3");
  const int inertia = mj_name2id(m, mjOBJ_NUMERIC, "link3_inertia");
  std::copy_n(m->numeric_data + m->numeric_adr[inertia], 3, m->body_inertia + 3 * link3);

  const int payload = mj_name2id(m, mjOBJ_BODY, "payload");
  m->body_mass[payload] = settings.payload_mass;
  std::fill_n(m->body_inertia + 3 * payload, 3, 0.4 * settings.payload_mass * kPayloadRadius * kPayloadRadius);

  for (std::size_t i = 0; i < kPumaJoints; ++i) {
    m->dof_frictionloss[i] *= settings.coulomb_share;
    torque_limit_[i] = m->actuator_ctrlrange[2 * i + 1];
  }
  mj_setConst(m, state_.get());
}

Result<void> PumaArm::place(PumaInput q) {
  for (std::size_t i = 0; i < kPumaJoints; ++i) {
    const double low = model_->jnt_range[2 * i], high = model_->jnt_range[2 * i + 1];
    if (!within(q[i], low, high)) {
      return bad("joint %zu at %.4g rad is outside its limits %.4g to %.4g rad", i + 1, q[i], low, high);
    }
  }
  mj_resetData(model_.get(), state_.get());
  std::copy(q.begin(), q.end(), state_->qpos);
  mj_forward(model_.get(), state_.get());
  return {};
}

bool PumaArm::refuse(const char* why) noexcept {
  fault_.assign(why);
  return false;
}

bool PumaArm::advance(double dt, const double* torque) {
  if (!(dt > 0) || !std::isfinite(dt)) return refuse("the time step is not positive");
  PumaVector q, qd;
  std::copy_n(state_->qpos, kPumaJoints, q.begin());
  std::copy_n(state_->qvel, kPumaJoints, qd.begin());
  const double n = std::ceil(dt / kLongestSubStep - 1e-9);
  model_->opt.timestep = dt / n;
  for (double i = 0; i < n; ++i) {
    bool good = guarded(mj_step1, model_.get(), state_.get());
    for (std::size_t j = 0; good && j < kPumaJoints; ++j) {
      state_->ctrl[j] = torque != nullptr ? torque[j] : state_->qfrc_bias[j] - kHoldDamping[j] * state_->qvel[j];
    }
    good = good && guarded(mj_step2, model_.get(), state_.get());
    if (!good) {
      std::copy(q.begin(), q.end(), state_->qpos);
      std::copy(qd.begin(), qd.end(), state_->qvel);
      return refuse(mujoco_error()[0] != '\0' ? mujoco_error()
                                              : "the simulated arm blew up: its state is not a number");
    }
  }
  return true;
}

bool PumaArm::step(PumaInput torque, double dt) {
  for (std::size_t i = 0; i < kPumaJoints; ++i) {
    if (std::isfinite(torque[i])) continue;
    char text[120];
    std::snprintf(text, sizeof text, "tau[%zu] is not finite", i);
    return refuse(text);
  }
  return advance(dt, torque.data());
}

bool PumaArm::step_locally_stable(double dt) { return advance(dt, nullptr); }

void PumaArm::brake() { std::fill_n(state_->qvel, kPumaJoints, 0.0); }

PumaInput PumaArm::position() const noexcept { return PumaInput(state_->qpos, kPumaJoints); }
PumaInput PumaArm::velocity() const noexcept { return PumaInput(state_->qvel, kPumaJoints); }

PumaVector PumaArm::bias_torque() {
  mj_forward(model_.get(), state_.get());
  PumaVector torque;
  std::copy_n(state_->qfrc_bias, kPumaJoints, torque.begin());
  return torque;
}

std::array<double, 36> PumaArm::mass_matrix() {
  mj_forward(model_.get(), state_.get());
  std::array<double, 36> full;
  mj_fullM(model_.get(), full.data(), state_->qM);
  return full;
}

std::array<double, 3> PumaArm::wrist_position() const {
  const double* p = state_->xpos + 3 * mj_name2id(model_.get(), mjOBJ_BODY, "link6");
  return {p[0], p[1], p[2]};
}

std::array<double, 9> PumaArm::wrist_rotation() const {
  std::array<double, 9> rotation;
  std::copy_n(state_->xmat + 9 * mj_name2id(model_.get(), mjOBJ_BODY, "link6"), 9, rotation.begin());
  return rotation;
}

}  // namespace chimera::library
