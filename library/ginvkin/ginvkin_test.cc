// SPDX-License-Identifier: Apache-2.0
// The generic kinematics components and those of the Puma, side by side on the same arm.
#include <gtest/gtest.h>

#include <cmath>
#include <string>

#include "chimera/task/rig.h"
#include "library/kinematics/puma560.h"

namespace chimera {
namespace {

using library::Puma560;
constexpr Puma560::Vector kPose{0.3, 0.6, -2.6, 0.4, 0.8, -0.2};

struct KinematicsTest : testing::Test {
  Rig forward{"gfwdkin"}, slopes{"fwdkin_jacobian"}, inverse{"ginvkin"};
  Rig puma_forward{"pfwdkin"}, puma_inverse{"pinvkin"};

  KinematicsTest() {
    for (Rig* rig : {&forward, &slopes, &inverse}) {
      rig->set("ndof", std::int32_t{6});
      for (std::size_t i = 0; i < 6; ++i) rig->set("dh", Puma560::kRows[i], i);
    }
  }
  void stand(const Puma560::Vector& q) {
    for (Rig* rig : {&forward, &slopes, &inverse, &puma_forward, &puma_inverse}) {
      for (std::size_t i = 0; i < 6; ++i) rig->set("q", q[i], i);
    }
  }
  void start() {
    stand(kPose);
    const Pose here = library::pose_of(Puma560::forward(kPose));
    inverse.set("xr", here);
    puma_inverse.set("xr", here);
    for (Rig* rig : {&forward, &slopes, &inverse, &puma_forward, &puma_inverse}) {
      const RigAnswer made = rig->init();
      ASSERT_TRUE(made) << made.text;
      ASSERT_TRUE(rig->on());
    }
  }
};

TEST_F(KinematicsTest, AllForwardKinematicsAgree) {
  start();
  for (Rig* rig : {&forward, &slopes, &puma_forward}) {
    ASSERT_TRUE(rig->cycle());
    const Pose xm = rig->get<Pose>("xm"), expected = library::pose_of(Puma560::forward(kPose));
    for (std::size_t i = 0; i < 3; ++i) EXPECT_NEAR(xm.position[i], expected.position[i], 1e-12);
    EXPECT_LT(library::angle_between(xm.orientation, expected.orientation), 1e-12);
  }
}

TEST_F(KinematicsTest, BothInversesFollowTheToolAlongAPath) {
  start();
  Puma560::Vector q = kPose;
  for (int step = 0; step < 500; ++step) {
    for (std::size_t i = 0; i < 6; ++i) {
      const auto phase = static_cast<double>(i);
      q[i] = kPose[i] + 0.4 * (std::sin(0.01 * step + phase) - std::sin(phase));
    }
    const Pose xr = library::pose_of(Puma560::forward(q));
    for (Rig* rig : {&inverse, &puma_inverse}) {
      rig->set("xr", xr);
      ASSERT_TRUE(rig->cycle());
      for (std::size_t i = 0; i < 6; ++i) ASSERT_NEAR(rig->get<double>("q_ref", i), q[i], 1e-5) << step;
    }
    EXPECT_LT(inverse.get<double>("residual"), 1e-6);
  }
}

TEST_F(KinematicsTest, APoseOutOfReachIsSaidAndNoFault) {
  start();
  const Pose far{{3, 0, 0}, {1, 0, 0, 0}};
  inverse.set("xr", far);
  puma_inverse.set("xr", far);
  ASSERT_TRUE(inverse.cycle());
  EXPECT_GT(inverse.get<double>("residual"), 1.5);
  ASSERT_TRUE(puma_inverse.cycle());
  EXPECT_FALSE(puma_inverse.get<bool>("is_reachable"));
  for (std::size_t i = 0; i < 6; ++i) EXPECT_EQ(puma_inverse.get<double>("q_ref", i), kPose[i]);
}

TEST_F(KinematicsTest, WhatIsNotFiniteIsRefused) {
  start();
  Puma560::Vector q = kPose;
  q[2] = std::nan("");
  stand(q);
  for (Rig* rig : {&forward, &slopes, &puma_forward}) EXPECT_EQ(rig->cycle().text, "q is not finite");
  EXPECT_EQ(inverse.on().text, "q is not finite: the search cannot begin there");
  EXPECT_EQ(puma_inverse.on().text, "q is not finite: no solution is near");
  const Pose bad{{0, 0, std::nan("")}, {1, 0, 0, 0}};
  for (Rig* rig : {&inverse, &puma_inverse}) {
    rig->set("xr", bad);
    EXPECT_EQ(rig->cycle().text, "xr is not finite or no orientation");
  }
}

TEST_F(KinematicsTest, ConstantsThatAreNoArmAreRefused) {
  forward.set("dh", library::DhLink{std::nan(""), 0, 0, 0}, 2);
  EXPECT_EQ(forward.init().text, "dh: a number is not finite");
  slopes.set("tool", Pose{{0, 0, 0}, {1, 1, 0, 0}});
  EXPECT_EQ(slopes.init().text, "tool: not finite, or the orientation is no unit quaternion");
}

}  // namespace
}  // namespace chimera
