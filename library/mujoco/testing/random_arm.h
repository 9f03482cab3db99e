// SPDX-License-Identifier: Apache-2.0
// For tests: arms of any number of joints, in our constants and as MJCF, and MuJoCo's inverse dynamics of them.
#pragma once

#include <gtest/gtest.h>
#include <mujoco/mujoco.h>

#include <cstring>
#include <memory>
#include <random>
#include <sstream>
#include <string>

#include "library/kinematics/dh_dynamics.h"

namespace chimera::library {

using Joints = std::array<double, kMostJoints>;

struct RandomArm {
  DhChain chain;
  std::array<LinkMass, kMostJoints> links{};
  std::array<Frame, kMostJoints> principal{};  // axes of the inertia at the centre of mass, in the frame of the link
  std::array<Vec3, kMostJoints> moments{};
  double payload = 0;

  RandomArm(std::mt19937& random, std::size_t joints) : random_(random) {
    chain.ndof = joints;
    chain.base = place();
    chain.tool = place();
    for (std::size_t i = 0; i < joints; ++i) {
      chain.dh[i] = {within(-0.5, 0.5), within(-3, 3), within(-0.5, 0.5), within(-3, 3)};
      principal[i] = frame_of(place());
      moments[i] = {within(0.05, 0.08), within(0.05, 0.08), within(0.05, 0.08)};
      links[i] = link(i);
    }
    payload = within(0, 3);
  }
  /// Body i is the previous frame turned by joint i. The transform after the turn is the place of the next body.
  std::string mjcf() const {
    std::ostringstream text;
    text.precision(17);
    text << "<mujoco><compiler angle=\"radian\"/><option gravity=\"1 2 -9\"/><worldbody>";
    Frame place = frame_of(chain.base);
    for (std::size_t i = 0; i < chain.ndof; ++i) {
      const Frame behind = frame_of(DhLink{chain.dh[i].a, chain.dh[i].alpha, chain.dh[i].d, 0}, 0);
      const Frame before = frame_of(DhLink{0, 0, 0, chain.dh[i].theta}, 0);
      text << "<body" << at(place * before) << "><joint type=\"hinge\" axis=\"0 0 1\" armature=\"" << links[i].rotor
           << "\" damping=\"" << links[i].friction << "\"/><inertial" << at(behind * principal[i])
           << " mass=\"" << links[i].mass << "\" diaginertia=\"" << moments[i][0] << " " << moments[i][1] << " "
           << moments[i][2] << "\"/>";
      place = behind;
    }
    text << "<body" << at(place * frame_of(chain.tool)) << "><inertial pos=\"0 0 0\" mass=\"" << payload
         << "\" diaginertia=\"1e-14 1e-14 1e-14\"/></body>";
    for (std::size_t i = 0; i < chain.ndof; ++i) text << "</body>";
    text << "</worldbody></mujoco>";
    return text.str();
  }

 private:
  static std::string at(const Frame& frame) {
    const Pose pose = pose_of(frame);
    std::ostringstream text;
    text.precision(17);
    text << " pos=\"" << pose.position[0] << " " << pose.position[1] << " " << pose.position[2] << "\" quat=\"";
    for (double part : pose.orientation) text << part << " ";
    text << "\"";
    return text.str();
  }
  double within(double low, double high) { return std::uniform_real_distribution<double>(low, high)(random_); }
  Pose place() {
    Pose made{{within(-0.2, 0.2), within(-0.2, 0.2), within(-0.2, 0.2)}, {0.3, within(-1, 1), within(-1, 1), 0.2}};
    double square = 0;
    for (double part : made.orientation) square += part * part;
    for (double& part : made.orientation) part /= std::sqrt(square);
    return made;
  }
  /// Inertia along the axes of the link, from moments about the principal axes.
  LinkMass link(std::size_t i) {
    LinkMass made{within(0.5, 10), {}, {}, within(0, 1), within(0, 5)};
    std::copy_n(principal[i].origin.at, 3, made.centre);
    const Vec3* axes[] = {&principal[i].x, &principal[i].y, &principal[i].z};
    constexpr std::size_t kRow[] = {0, 1, 2, 0, 0, 1}, kColumn[] = {0, 1, 2, 1, 2, 2};
    for (std::size_t e = 0; e < 6; ++e) {
      for (std::size_t k = 0; k < 3; ++k) {
        made.inertia[e] += moments[i][k] * (*axes[k])[kRow[e]] * (*axes[k])[kColumn[e]];
      }
    }
    return made;
  }

  std::mt19937& random_;
};

struct MujocoArm {
  std::unique_ptr<mjModel, void (*)(mjModel*)> model{nullptr, mj_deleteModel};
  std::unique_ptr<mjData, void (*)(mjData*)> state{nullptr, mj_deleteData};

  explicit MujocoArm(const std::string& text) {
    const std::unique_ptr<mjVFS> files(new mjVFS);
    mj_defaultVFS(files.get());
    mj_makeEmptyFileVFS(files.get(), "arm.xml", static_cast<int>(text.size()));
    std::memcpy(files->filedata[0], text.data(), text.size());
    char why[200] = "";
    model.reset(mj_loadXML("arm.xml", files.get(), why, sizeof why));
    mj_deleteVFS(files.get());
    EXPECT_STREQ(why, "");
    if (model) state.reset(mj_makeData(model.get()));
  }
  const double* torque(const Joints& q, const Joints& qd, const Joints& qdd) {
    std::copy_n(q.begin(), model->nq, state->qpos);
    std::copy_n(qd.begin(), model->nv, state->qvel);
    std::copy_n(qdd.begin(), model->nv, state->qacc);
    mj_inverse(model.get(), state.get());
    return state->qfrc_inverse;
  }
};

}  // namespace chimera::library
