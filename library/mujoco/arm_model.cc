// SPDX-License-Identifier: Apache-2.0
// Finds the chain of hinges in a MuJoCo model, with its limits, and derives its Denavit-Hartenberg constants.
#include "library/mujoco/arm_model.h"

#include <mujoco/mujoco.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "library/mujoco/refusal.h"

namespace chimera::library {
namespace {

const char* joint_name(const mjModel* m, int joint) {
  const char* name = mj_id2name(m, mjOBJ_JOINT, joint);
  return name != nullptr ? name : "without a name";
}

/// Joints from the world to `body`, in that order.
std::vector<int> joints_to(const mjModel* m, int body) {
  std::vector<int> joints;
  for (int b = body; b > 0; b = m->body_parentid[b]) {
    for (int j = m->body_jntnum[b] - 1; j >= 0; --j) joints.push_back(m->body_jntadr[b] + j);
  }
  std::reverse(joints.begin(), joints.end());
  return joints;
}

int body_with_most_hinges(const mjModel* m) {
  int best = 0;
  std::size_t most = 0;
  for (int body = 1; body < m->nbody; ++body) {
    const std::vector<int> joints = joints_to(m, body);
    const bool hinges = std::ranges::all_of(joints, [&](int j) { return m->jnt_type[j] == mjJNT_HINGE; });
    if (hinges && joints.size() > most) {
      most = joints.size();
      best = body;
    }
  }
  return best;
}

Frame frame_at(const double* p, const double* r) {
  return {{p[0], p[1], p[2]}, {r[0], r[3], r[6]}, {r[1], r[4], r[7]}, {r[2], r[5], r[8]}};
}

/// The body that carries the tip, and the frame of the tip at zero.
struct Tip {
  int body = 0;
  Frame frame;
};

Result<Tip> find_tip(const mjModel* m, const mjData* d, const char* name) {
  if (name[0] == '\0') {
    const int body = body_with_most_hinges(m);
    return Tip{body, frame_at(d->xpos + 3 * body, d->xmat + 9 * body)};
  }
  if (const int body = mj_name2id(m, mjOBJ_BODY, name); body >= 0) {
    return Tip{body, frame_at(d->xpos + 3 * body, d->xmat + 9 * body)};
  }
  if (const int site = mj_name2id(m, mjOBJ_SITE, name); site >= 0) {
    return Tip{m->site_bodyid[site], frame_at(d->site_xpos + 3 * site, d->site_xmat + 9 * site)};
  }
  return refusal("there is no body and no site '%s'", name);
}

/// Sum of the torque limits of the motors on a joint.
double torque_limit(const mjModel* m, int joint) {
  double sum = 0;
  for (int i = 0; i < m->nu; ++i) {
    if (m->actuator_trntype[i] != mjTRN_JOINT || m->actuator_trnid[2 * i] != joint) continue;
    const double gear = std::abs(m->actuator_gear[6 * i]);
    double most = kNoModelLimit;
    if (m->actuator_forcelimited[i]) most = gear * m->actuator_forcerange[2 * i + 1];
    const bool is_motor = m->actuator_gaintype[i] == mjGAIN_FIXED && m->actuator_biastype[i] == mjBIAS_NONE;
    if (is_motor && m->actuator_ctrllimited[i]) {
      const double gain = std::abs(m->actuator_gainprm[mjNGAIN * i]);
      most = std::min(most, gear * gain * m->actuator_ctrlrange[2 * i + 1]);
    }
    sum += most;
  }
  return sum > 0 ? std::min(sum, kNoModelLimit) : kNoModelLimit;
}

void place_joint(const mjModel* m, int joint, std::size_t i, ArmModel& arm) {
  arm.dof[i] = m->jnt_dofadr[joint];
  arm.position[i] = m->jnt_qposadr[joint];
}

void describe_joint(const mjModel* m, int joint, std::size_t i, ArmModel& arm) {
  place_joint(m, joint, i, arm);
  const bool limited = m->jnt_limited[joint] != 0;
  arm.low[i] = limited ? m->jnt_range[2 * joint] : -kNoModelLimit;
  arm.high[i] = limited ? m->jnt_range[2 * joint + 1] : kNoModelLimit;
  arm.is_continuous[i] = !limited;
  arm.speed_limit[i] = kNoModelLimit;
  arm.torque_limit[i] = torque_limit(m, joint);
}

/// True if the joint lies where the file says, to the accuracy of a file with six digits.
bool is_in_place(const mjData* d, int joint, const JointAxis& axis) {
  const double *at = d->xanchor + 3 * joint, *along = d->xaxis + 3 * joint;
  const Vec3 off = Vec3{at[0], at[1], at[2]} - axis.point;
  const Vec3 turned = Vec3{along[0], along[1], along[2]} - (1 / length(axis.direction)) * axis.direction;
  return length(off) < 1e-6 * (1 + length(axis.point)) && length(turned) < 1e-6;
}

}  // namespace

void stand_at_zero(const mjModel_* m, mjData_* d) {
  mj_resetData(m, d);
  mju_copy(d->qpos, m->qpos0, m->nq);
  for (int j = 0; j < m->njnt; ++j) {
    if (m->jnt_type[j] == mjJNT_HINGE) d->qpos[m->jnt_qposadr[j]] = 0;
  }
  mj_kinematics(m, d);
}

Result<ArmModel> find_arm(const mjModel_* m, mjData_* d, const char* tip_name) {
  stand_at_zero(m, d);
  const Result<Tip> tip = find_tip(m, d, tip_name);
  if (!tip) return tip.error();
  const std::vector<int> joints = joints_to(m, tip->body);
  if (joints.empty()) return refusal("found no joint that turns a link of an arm");
  if (joints.size() > kMostJoints) return refusal("found %zu joints, expected at most %zu", joints.size(), kMostJoints);
  ArmModel arm;
  arm.ndof = joints.size();
  std::array<JointAxis, kMostJoints> axes;
  for (std::size_t i = 0; i < joints.size(); ++i) {
    const int j = joints[i];
    if (m->jnt_type[j] != mjJNT_HINGE)
      return refusal("joint '%s' is no hinge: an arm has hinges only", joint_name(m, j));
    describe_joint(m, j, i, arm);
    // MuJoCo's compiler refuses such limits in MJCF; in URDF it would ignore them.
    if (m->jnt_range[2 * j] > m->jnt_range[2 * j + 1]) {
      return refusal("the lower limit of joint '%s' is above its upper one", joint_name(m, j));
    }
    std::copy_n(d->xanchor + 3 * j, 3, axes[i].point.at);
    std::copy_n(d->xaxis + 3 * j, 3, axes[i].direction.at);
  }
  arm.chain = dh_of_axes(std::span(axes.data(), arm.ndof), tip->frame);
  return arm;
}

Result<ArmModel> find_arm(mjModel_* m, mjData_* d, const UrdfChain& chain) {
  stand_at_zero(m, d);
  ArmModel arm;
  arm.ndof = chain.chain.ndof;
  for (std::size_t i = 0; i < arm.ndof; ++i) {
    const int j = mj_name2id(m, mjOBJ_JOINT, chain.joints[i].c_str());
    if (j < 0 || m->jnt_type[j] != mjJNT_HINGE || !is_in_place(d, j, chain.axes[i]))
      return refusal("joint '%s' lies elsewhere in MuJoCo: take <compiler> out of the file", chain.joints[i].c_str());
    place_joint(m, j, i, arm);
    m->jnt_limited[j] = chain.is_continuous[i] ? 0 : 1;
    m->jnt_range[2 * j] = chain.low[i];
    m->jnt_range[2 * j + 1] = chain.high[i];
  }
  arm.low = chain.low;
  arm.high = chain.high;
  arm.speed_limit = chain.speed;
  arm.torque_limit = chain.effort;
  arm.is_continuous = chain.is_continuous;
  arm.chain = chain.chain;
  return arm;
}

}  // namespace chimera::library
