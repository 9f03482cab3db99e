// SPDX-License-Identifier: Apache-2.0
// Row 16: one cycle of each simulated robot beside the steps of MuJoCo alone that it takes, of the same arm; computed
// torque beside MuJoCo's inverse dynamics of that arm.
// Components: puma puma_torque rmms mujoco_robot mujoco_robot_velocity mujoco_robot_torque urdf_model computed_torque
#include <mujoco/mujoco.h>

#include <algorithm>
#include <cstring>
#include <memory>
#include <stdexcept>

#include "bench/component.h"
#include "library/kinematics/testing/puma560_links.h"
#include "library/mujoco/simulated_arm.h"
#include "library/rmms/module_store.h"

namespace chimera {
namespace {

using bench::ComponentCase;
using library::ArmRig;
using library::kBent;
using library::Puma560;
using library::SimulatedArm;

constexpr char kPumaFile[] = "library/puma_torque/puma560.xml", kStore[] = "library/rmms/rmms_a.store";
constexpr char kUrdf[] = "library/urdf_model/puma560.urdf";
constexpr std::array<double, 6> kUpright{0, 1.5707963, -1.5707963, 0, 0, 0};  // rad
constexpr std::array<double, 6> kZero{};

void check(const Result<void>& made) {
  if (!made) throw std::runtime_error(std::string(made.error().message.view()));
}

std::shared_ptr<SimulatedArm> puma() {
  const auto arm = std::make_shared<SimulatedArm>();
  check(arm->load(source_path(kPumaFile).c_str()));
  check(arm->place(kUpright));
  return arm;
}

/// As puma and puma_torque have it when nothing is said: without Coulomb friction.
std::shared_ptr<SimulatedArm> smooth_puma() {
  const auto arm = puma();
  std::fill_n(arm->model()->dof_frictionloss, arm->model()->nv, 0.0);
  mj_setConst(arm->model(), arm->state());
  check(arm->place(kUpright));
  return arm;
}

std::shared_ptr<SimulatedArm> modular() {
  const auto modules = library::ModuleStore::read(source_path(kStore).c_str());
  if (!modules) throw std::runtime_error(std::string(modules.error().message.view()));
  const std::string text = modules->mjcf();
  const std::unique_ptr<mjVFS> files(new mjVFS);
  mj_defaultVFS(files.get());
  mj_makeEmptyFileVFS(files.get(), "rmms.xml", static_cast<int>(text.size()));
  std::memcpy(files->filedata[0], text.data(), text.size());
  const auto arm = std::make_shared<SimulatedArm>();
  const Result<void> loaded = arm->load("rmms.xml", "tip", files.get());
  mj_deleteVFS(files.get());
  check(loaded);
  return arm;
}

/// A millisecond in two steps of MuJoCo: with the weight carried the arm stands, without it hangs in the end.
bench::Comparison::Body two_steps(const std::shared_ptr<SimulatedArm>& arm, bool is_carried) {
  arm->model()->opt.timestep = 0.5e-3;
  return [arm, is_carried](std::uint64_t n) {
    const mjModel* m = arm->model();
    mjData* d = arm->state();
    for (; n > 0; --n) {
      for (int half = 0; half < 2; ++half) {
        mj_step1(m, d);
        for (int i = 0; i < m->nv; ++i) d->qfrc_applied[i] = is_carried ? d->qfrc_bias[i] - 50 * d->qvel[i] : 0;
        mj_step2(m, d);
      }
    }
  };
}

void stand(ArmRig& rig) { rig.give("start_pose", kUpright); }
void stand_of_file(ArmRig& rig) {
  stand(rig);
  rig.resource("model", source_path(kPumaFile).c_str());
}

std::vector<ComponentCase> robots() {
  return {{"puma", "2 x mj_step", [](ArmRig& rig) { stand(rig), rig.give("q_ref", kUpright); },
           two_steps(smooth_puma(), true)},
          {"mujoco_robot", "2 x mj_step", [](ArmRig& rig) { stand_of_file(rig), rig.give("q_ref", kUpright); },
           two_steps(puma(), true)},
          {"mujoco_robot_velocity", "2 x mj_step", [](ArmRig& rig) { stand_of_file(rig), rig.give("qd_ref", kZero); },
           two_steps(puma(), true)},
          {"mujoco_robot_torque", "2 x mj_step", [](ArmRig& rig) { stand_of_file(rig), rig.give("tau", kZero); },
           two_steps(puma(), false)},
          {"puma_torque", "2 x mj_step", [](ArmRig& rig) {
             stand(rig), rig.give("tau", kZero), rig.resource("model", "puma560.xml"); },
           two_steps(smooth_puma(), false)},
          {"rmms", "2 x mj_step", [](ArmRig& rig) {
             rig.resource("store", source_path(kStore).c_str());
             rig.give("q_ref", kZero); }, two_steps(modular(), true)}};
}

std::vector<ComponentCase> told_by_files() {
  return {{"urdf_model", "an empty loop", [](ArmRig& rig) { rig.resource("model", source_path(kUrdf).c_str()); },
           [](std::uint64_t n) {
             for (; n > 0; --n) bench::keep(n);
           }}};
}

std::vector<ComponentCase> inverse_dynamics() {
  const auto arm = puma();
  return {{"computed_torque", "mj_inverse", [](ArmRig& rig) {
             rig.build_puma();
             for (std::size_t i = 0; i < 6; ++i) rig.set("links", library::kPuma560Links[i], i);
             for (const char* port : {"q", "q_ref", "qd", "qd_ref", "qdd_ref"}) rig.give(port, kBent);
             rig.give("tau_max", Puma560::kHigh);
           },
           [arm](std::uint64_t n) {
             mjData* d = arm->state();
             for (; n > 0; --n) {
               std::ranges::copy(kBent, d->qpos), std::ranges::copy(kBent, d->qvel), std::ranges::copy(kBent, d->qacc);
               mj_inverse(arm->model(), d);
               bench::keep(d->qfrc_inverse);
             }
           }}};
}

bool is_linked(const char* component) try {
  return (Rig(component), true);
} catch (const std::invalid_argument&) {
  std::fprintf(stderr, "row 16: %s is not measured: what it needs was not found\n", component);
  return false;
}

}  // namespace
}  // namespace chimera

int main(int argc, char** argv) try {
  using namespace chimera;
  const bench::Stage stage;
  int worst = bench::measure(16, robots(), argc, argv);
  if (is_linked("urdf_model")) worst = std::max(worst, bench::measure(16, told_by_files(), argc, argv));
  return std::max(worst, bench::measure(16, inverse_dynamics(), argc, argv));
} catch (const std::exception& wrong) {
  std::fprintf(stderr, "row 16: %s\n", wrong.what());
  return 1;
}
