// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <memory>

#include "chimera/task/rig.h"
#include "library/kinematics/puma560.h"
#include "library/kinematics/testing/puma560_links.h"

namespace chimera {
namespace {

constexpr std::array<double, 6> kStretched{0, 0, -1.5707963267948966, 0, 0, 0};

struct PumaTorqueTest : ::testing::Test {
  Rig rig{"puma_torque"};
  void give(const std::array<double, 6>& pose) {
    rig.resource("model", "puma560.xml");
    for (std::size_t i = 0; i < 6; ++i) rig.set("start_pose", pose[i], i);
    for (std::size_t i = 0; i < 6; ++i) rig.set("tau", 0.0, i);
  }
  void start() {
    give(kStretched);
    const RigAnswer made = rig.init();
    ASSERT_TRUE(made) << made.text;
    ASSERT_TRUE(rig.on());
  }
};

TEST_F(PumaTorqueTest, PublishesItsJointsAndLimitsAtInit) {
  start();
  EXPECT_EQ(rig.get<std::int32_t>("ndof"), 6);
  EXPECT_EQ(rig.get<double>("tau_max", 0), 97.6);
  EXPECT_EQ(rig.get<double>("tau_max", 5), 21.3);
}

// An arm that is pushed against its limits at full torque passes them by up to 0.29 rad. If a cycle fails there, the
// out-vars hold the state before that cycle, with a speed, while the arm has braked. They must not count as another arm
// in motion.
TEST_F(PumaTorqueTest, ComesBackFromAnErrorWhereItStands) {
  start();
  std::array<double, 6> q{}, qd{};
  double outside = 0, speed = 0;
  for (int cycle = 0; cycle < 3000 && (outside < 0.1 || speed < 0.1); ++cycle) {
    const double sign = cycle / 500 % 2 == 0 ? 1 : -1;
    for (std::size_t i = 0; i < 6; ++i) rig.set("tau", sign * rig.get<double>("tau_max", i), i);
    ASSERT_TRUE(rig.cycle(milliseconds(1)));
    outside = speed = 0;
    for (std::size_t i = 0; i < 6; ++i) {
      q[i] = rig.get<double>("q", i);
      qd[i] = rig.get<double>("qd", i);
      outside = std::max({outside, q[i] - library::Puma560::kHigh[i], library::Puma560::kLow[i] - q[i]});
      speed = std::max(speed, std::abs(qd[i]));
    }
  }
  ASSERT_GE(outside, 0.1);
  rig.set("tau", std::nan(""), 0);
  ASSERT_FALSE(rig.cycle(milliseconds(1)));
  (void)rig.error();
  ASSERT_TRUE(rig.clear());
  for (std::size_t i = 0; i < 6; ++i) rig.set("q", q[i], i);  // the failed cycle published nothing
  for (std::size_t i = 0; i < 6; ++i) rig.set("qd", qd[i], i);
  for (const char* port : {"q", "qd"}) rig.inherit(port, milliseconds(2));
  const RigAnswer on = rig.on();
  ASSERT_TRUE(on) << on.text;
  for (std::size_t i = 0; i < 6; ++i) EXPECT_EQ(rig.get<double>("q", i), q[i]) << i;
  for (std::size_t i = 0; i < 6; ++i) EXPECT_EQ(rig.get<double>("qd", i), 0) << i;
}

TEST_F(PumaTorqueTest, PublishesItsGeometryAndItsMassesWithoutPayload) {
  rig.set("payload_mass", 5.0);
  start();
  for (std::size_t i = 0; i < 6; ++i) {
    const auto row = rig.get<library::DhLink>("dh", i), wanted = library::Puma560::kRows[i];
    EXPECT_NEAR(row.a, wanted.a, 1e-12);
    EXPECT_NEAR(row.alpha, wanted.alpha, 1e-12);
    EXPECT_NEAR(row.d, wanted.d, 1e-12);
    EXPECT_NEAR(row.theta, wanted.theta, 1e-12);
    EXPECT_NEAR(rig.get<double>("q_min", i), library::Puma560::kLow[i], 1e-12);
    EXPECT_NEAR(rig.get<double>("q_max", i), library::Puma560::kHigh[i], 1e-12);
    const auto link = rig.get<library::LinkMass>("links", i), published = library::kPuma560Links[i];
    EXPECT_NEAR(link.rotor, published.rotor, 1e-12);
    EXPECT_NEAR(link.friction, published.friction, 1e-12);
    EXPECT_NEAR(link.inertia[1], published.inertia[1], 1e-12);
    if (i == 0) continue;  // of link 1 only one inertia is published, and only that has an effect
    EXPECT_NEAR(link.mass, published.mass, 1e-12);
    for (std::size_t c = 0; c < 3; ++c) EXPECT_NEAR(link.centre[c], published.centre[c], 1e-12);
    for (std::size_t e = 0; e < 6; ++e) EXPECT_NEAR(link.inertia[e], published.inertia[e], 1e-12) << i << " " << e;
  }
  EXPECT_EQ(rig.get<Pose>("base").orientation[0], 1);
  EXPECT_EQ(rig.get<Pose>("tool").orientation[0], 1);
}

TEST_F(PumaTorqueTest, PublishesItsStartPoseAtOn) {
  start();
  for (std::size_t i = 0; i < 6; ++i) {
    EXPECT_EQ(rig.get<double>("q", i), kStretched[i]);
    EXPECT_EQ(rig.get<double>("qd", i), 0);
  }
}

TEST_F(PumaTorqueTest, FallsWithoutTorqueAndHoldsWhenTheConfigurationIsIllegal) {
  start();
  for (int i = 0; i < 100; ++i) ASSERT_TRUE(rig.cycle());
  EXPECT_LT(rig.get<double>("q", 1), -0.03);
  EXPECT_LT(rig.get<double>("qd", 1), -0.5);
  EXPECT_FALSE(rig.get<bool>("held"));
  rig.illegal(true);
  ASSERT_TRUE(rig.cycle());
  EXPECT_FALSE(rig.get<bool>("held")) << "it has not come to rest";
  for (int i = 0; i < 1000; ++i) ASSERT_TRUE(rig.cycle());
  EXPECT_TRUE(rig.get<bool>("held"));
  const double held = rig.get<double>("q", 1);
  rig.set("tau", std::nan(""), 1);
  for (int i = 0; i < 500; ++i) ASSERT_TRUE(rig.cycle());
  EXPECT_NEAR(rig.get<double>("q", 1), held, 1e-4);
}

TEST_F(PumaTorqueTest, TorqueThatIsNotANumberIsAFaultAndBrakes) {
  start();
  for (int i = 0; i < 100; ++i) ASSERT_TRUE(rig.cycle());
  rig.set("tau", std::numeric_limits<double>::infinity(), 3);
  const RigAnswer answer = rig.cycle();
  EXPECT_FALSE(answer);
  EXPECT_EQ(answer.text, "tau[3] is not finite");
  EXPECT_FALSE(rig.error());
  EXPECT_EQ(rig.get<double>("qd", 1), 0);
  EXPECT_TRUE(rig.clear());
}

TEST_F(PumaTorqueTest, BrakesAtOff) {
  start();
  for (int i = 0; i < 100; ++i) ASSERT_TRUE(rig.cycle());
  ASSERT_TRUE(rig.off());
  for (std::size_t i = 0; i < 6; ++i) EXPECT_EQ(rig.get<double>("qd", i), 0);
}

TEST_F(PumaTorqueTest, ReinitTakesAnotherPayloadWhereItStands) {
  start();
  for (int i = 0; i < 100; ++i) ASSERT_TRUE(rig.cycle());
  const double here = rig.get<double>("q", 1);
  rig.set("payload_mass", 3.0);
  ASSERT_TRUE(rig.reinit());
  ASSERT_TRUE(rig.on());
  EXPECT_EQ(rig.get<double>("q", 1), here);
  EXPECT_EQ(rig.get<double>("qd", 1), 0);
}

TEST_F(PumaTorqueTest, RefusesAPoseOutsideTheLimits) {
  std::array<double, 6> pose = kStretched;
  pose[4] = 2;
  give(pose);
  const RigAnswer answer = rig.init();
  EXPECT_FALSE(answer);
  EXPECT_EQ(answer.text, "joint 5 at 2 rad is outside its limits -1.745 to 1.745 rad");
}

}  // namespace
}  // namespace chimera
