// SPDX-License-Identifier: Apache-2.0
// Loads the model of the Puma 560 and sets its payload and friction.
#include "library/puma_torque/puma_arm.h"

#include <mujoco/mujoco.h>

#include <algorithm>
#include <cstring>
#include <memory>

#include "library/mujoco/refusal.h"
#include "puma560_mjcf.h"

namespace chimera::library {
namespace {

// Damping of the drives while the configuration is illegal (N.m.s/rad): about 20/s times the inertia of each joint.
constexpr PumaVector kHoldDamping{80, 80, 20, 4, 4, 4};
constexpr double kPayloadRadius = 0.05;

struct FilesRelease {
  void operator()(mjVFS* files) const {
    mj_deleteVFS(files);
    delete files;
  }
};

// A component runs from a sealed copy of its object, so it cannot find files beside the original.
std::unique_ptr<mjVFS, FilesRelease> built_in_files() {
  std::unique_ptr<mjVFS, FilesRelease> files(new mjVFS);
  mj_defaultVFS(files.get());
  mj_makeEmptyFileVFS(files.get(), kPumaModel, sizeof kPumaMjcf - 1);
  std::memcpy(files->filedata[0], kPumaMjcf, sizeof kPumaMjcf - 1);
  return files;
}

bool within(double value, double low, double high) { return value >= low && value <= high; }

}  // namespace

Result<void> PumaArm::read_model(const char* mjcf_path) {
  const bool built_in = std::strcmp(mjcf_path, kPumaModel) == 0;
  const std::unique_ptr<mjVFS, FilesRelease> files = built_in ? built_in_files() : nullptr;
  if (Result<void> read = arm_.load(mjcf_path, "", files.get()); !read) return read;
  const mjModel* m = arm_.model();
  if (m->nq != 6 || m->nv != 6 || m->nu != 6) {
    return refusal("%s: found %d joints and %d motors, expected 6 and 6", mjcf_path, static_cast<int>(m->nv),
               static_cast<int>(m->nu));
  }
  for (const char* body : {"link3", "link6", "payload"}) {
    if (mj_name2id(m, mjOBJ_BODY, body) < 0) return refusal("%s: there is no body '%s'", mjcf_path, body);
  }
  const int inertia = mj_name2id(m, mjOBJ_NUMERIC, "link3_inertia");
  if (inertia < 0 || m->numeric_size[inertia] != 3) {
    return refusal("%s: expected three numbers 'link3_inertia' under <custom>", mjcf_path);
  }
  return arm_.load(mjcf_path, "payload", files.get());  // the tool is the flange
}

Result<void> PumaArm::load(const char* mjcf_path, const PumaSettings& settings) {
  if (!within(settings.payload_mass, 0, 10)) {
    return refusal("payload_mass is %g kg, expected 0 to 10 kg", settings.payload_mass);
  }
  if (!within(settings.coulomb_share, 0, 1))
    return refusal("coulomb_share is %g, expected 0 to 1", settings.coulomb_share);
  if (Result<void> read = read_model(mjcf_path); !read) return read;
  apply(settings);
  return place(PumaVector{});
}

void PumaArm::apply(const PumaSettings& settings) {
  mjModel* m = arm_.model();
  const int link3 = mj_name2id(m, mjOBJ_BODY, "link3");
  const int inertia = mj_name2id(m, mjOBJ_NUMERIC, "link3_inertia");
  std::copy_n(m->numeric_data + m->numeric_adr[inertia], 3, m->body_inertia + 3 * link3);

  const int payload = mj_name2id(m, mjOBJ_BODY, "payload");
  m->body_mass[payload] = 0;
  std::fill_n(m->body_inertia + 3 * payload, 3, 0);
  links_ = link_masses(m, arm_.state(), arm_.arm());
  m->body_mass[payload] = settings.payload_mass;
  std::fill_n(m->body_inertia + 3 * payload, 3, 0.4 * settings.payload_mass * kPayloadRadius * kPayloadRadius);

  for (std::size_t i = 0; i < kPumaJoints; ++i) {
    m->dof_frictionloss[i] *= settings.coulomb_share;
    torque_limit_[i] = m->actuator_ctrlrange[2 * i + 1];
  }
  arm_.set_hold_damping(kHoldDamping);
  mj_setConst(m, arm_.state());
}

Result<void> PumaArm::place(PumaInput q) { return arm_.place(q); }

bool PumaArm::step(PumaInput torque, double dt) { return arm_.step(ArmInterface::kTorque, torque, dt); }
bool PumaArm::step_locally_stable(double dt) { return arm_.step_locally_stable(dt); }
void PumaArm::brake() { arm_.brake(); }

PumaInput PumaArm::position() const noexcept { return arm_.position().first<kPumaJoints>(); }
PumaInput PumaArm::velocity() const noexcept { return arm_.velocity().first<kPumaJoints>(); }

}  // namespace chimera::library
