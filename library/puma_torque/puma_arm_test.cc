// SPDX-License-Identifier: Apache-2.0
#include "library/puma_torque/puma_arm.h"

#include <gtest/gtest.h>
#include <mujoco/mujoco.h>
#include <unistd.h>

#include <cmath>
#include <fstream>
#include <limits>
#include <string>

#include "chimera/base/testing/tree_path.h"
#include "chimera/base/math.h"
#include "library/mujoco/mujoco_guard.h"
#include "library/puma_torque/testing/puma_mechanics.h"

namespace chimera::library {
namespace {

constexpr PumaVector kQz{};
constexpr PumaVector kQr{0, math::kPi / 2, -math::kPi / 2, 0, 0, 0};
constexpr PumaVector kQs{0, 0, -math::kPi / 2, 0, 0, 0};
// In the published nominal pose joint 3 is at +180 degrees; -180 is the same place within the limits.
constexpr PumaVector kQn{0, math::kPi / 4, -math::kPi, 0, math::kPi / 4, 0};

const char* model_path() { return kPumaModel; }

struct PumaArmTest : ::testing::Test {
  PumaArm arm;
  void load(PumaSettings settings = {}) {
    const Result<void> loaded = arm.load(model_path(), settings);
    ASSERT_TRUE(loaded) << loaded.error().message.view();
  }
  void expect_gravity(const PumaVector& q, const PumaVector& published) {
    ASSERT_TRUE(arm.place(q));
    const PumaVector found = bias_torque(arm);
    for (std::size_t i = 0; i < kPumaJoints; ++i) EXPECT_NEAR(found[i], published[i], 6e-5) << "joint " << i + 1;
  }
  void expect_wrist(const PumaVector& q, std::array<double, 3> p, std::array<double, 9> r) {
    ASSERT_TRUE(arm.place(q));
    for (std::size_t i = 0; i < 3; ++i) EXPECT_NEAR(wrist_position(arm)[i], p[i], 6e-5);
    for (std::size_t i = 0; i < 9; ++i) EXPECT_NEAR(wrist_rotation(arm)[i], r[i], 1e-6);
  }
};

constexpr std::array<double, 9> kUpright{1, 0, 0, 0, 1, 0, 0, 0, 1};
constexpr std::array<double, 9> kLevel{0, 0, 1, 0, 1, 0, -1, 0, 0};

TEST_F(PumaArmTest, HasThePublishedForwardKinematics) {
  load();
  expect_wrist(kQz, {.4521, -.15005, .4318}, kUpright);
  expect_wrist(kQr, {.0203, -.15005, .8636}, kUpright);
  expect_wrist(kQs, {.8636, -.15005, -.0203}, kLevel);
  expect_wrist(kQn, {.5963, -.15005, -.01435}, kLevel);
}

TEST_F(PumaArmTest, HasThePublishedGravityTorques) {
  load();
  expect_gravity(kQz, {0, 37.4837, .2489, 0, 0, 0});
  expect_gravity(kQr, {0, -.7752, .2489, 0, 0, 0});
  expect_gravity(kQs, {0, 46.0069, 8.7722, 0, .0283, 0});
  expect_gravity(kQn, {0, 31.6399, 6.0351, 0, .0283, 0});
}

TEST_F(PumaArmTest, HasThePublishedMassMatrix) {
  load();
  ASSERT_TRUE(arm.place(kQn));
  const auto m = mass_matrix(arm);
  const PumaVector diagonal{3.6594, 4.4137, .9378, .1925, .1713, .1941};
  for (std::size_t i = 0; i < kPumaJoints; ++i) EXPECT_NEAR(m[7 * i], diagonal[i], 6e-5) << "joint " << i + 1;
  EXPECT_NEAR(m[1], -.4044, 6e-5);
  EXPECT_EQ(m[1], m[6]);
}

TEST_F(PumaArmTest, PayloadAddsItsWeightAtTheFlange) {
  load({.payload_mass = 2});
  ASSERT_TRUE(arm.place(kQs));
  // Arm stretched horizontally: the wrist is 0.8636 m out, and the flange points outwards.
  EXPECT_NEAR(bias_torque(arm)[1], 46.0069 + 2 * 9.81 * (.8636 + .05625), 1e-3);
  EXPECT_NEAR(bias_torque(arm)[4], (2 * .05625 + .09 * .032) * 9.81, 1e-6);
  PumaVector upright = kQs;
  upright[4] = math::kPi / 2;
  ASSERT_TRUE(arm.place(upright));
  EXPECT_NEAR(bias_torque(arm)[1], 46.0069 - .09 * .032 * 9.81 + 2 * 9.81 * .8636, 1e-3);
  EXPECT_NEAR(bias_torque(arm)[4], 0, 1e-6);
}

TEST_F(PumaArmTest, StandsStillUnderItsGravityTorque) {
  load();
  ASSERT_TRUE(arm.place(kQs));
  for (int i = 0; i < 1000; ++i) ASSERT_TRUE(arm.step(bias_torque(arm), 1e-3));
  for (std::size_t j = 0; j < kPumaJoints; ++j) EXPECT_NEAR(arm.position()[j], kQs[j], 1e-9);
}

TEST_F(PumaArmTest, FallsAsItsInertiaSaysWithoutTorque) {
  load();
  ASSERT_TRUE(arm.place(kQs));
  ASSERT_TRUE(arm.step(PumaVector{}, 0.5e-3));
  EXPECT_LT(arm.velocity()[1], 0);
  const double after_half = arm.velocity()[1];
  ASSERT_TRUE(arm.place(kQs));
  ASSERT_TRUE(arm.step(PumaVector{}, 1e-3));
  EXPECT_NEAR(arm.velocity()[1], 2 * after_half, 1e-2 * std::abs(after_half));
}

TEST_F(PumaArmTest, MovesTheSameInOneLongStepAsInItsSubSteps) {
  load({.payload_mass = 1});
  PumaVector torque{5, 40, 8, 1, 1, 1};
  ASSERT_TRUE(arm.place(kQs));
  ASSERT_TRUE(arm.step(torque, 4e-3));
  const PumaVector once{arm.position()[0], arm.position()[1], arm.position()[2]};
  ASSERT_TRUE(arm.place(kQs));
  for (int i = 0; i < 8; ++i) ASSERT_TRUE(arm.step(torque, 0.5e-3));
  for (std::size_t j = 0; j < 3; ++j) EXPECT_DOUBLE_EQ(arm.position()[j], once[j]);
}

TEST_F(PumaArmTest, DrivesGiveNoMoreThanTheirLimit) {
  load();
  const PumaVector published{97.6, 186.4, 89.4, 24.2, 20.1, 21.3};
  EXPECT_EQ(arm.torque_limit(), published);
  ASSERT_TRUE(arm.place(kQr));
  ASSERT_TRUE(arm.step(PumaVector{1000, 0, 0, 0, 0, 0}, 1e-3));
  const double cut = arm.velocity()[0];
  ASSERT_TRUE(arm.place(kQr));
  ASSERT_TRUE(arm.step(PumaVector{97.6, 0, 0, 0, 0, 0}, 1e-3));
  EXPECT_GT(cut, 0);
  EXPECT_DOUBLE_EQ(arm.velocity()[0], cut);
}

TEST_F(PumaArmTest, CoulombFrictionHoldsAgainstASmallTorque) {
  load({.coulomb_share = 1});
  ASSERT_TRUE(arm.place(kQr));
  for (int i = 0; i < 500; ++i) ASSERT_TRUE(arm.step(PumaVector{20, 0, 0, 0, 0, 0}, 1e-3));
  const double held = arm.position()[0];
  load({.coulomb_share = 0});
  ASSERT_TRUE(arm.place(kQr));
  for (int i = 0; i < 500; ++i) ASSERT_TRUE(arm.step(PumaVector{20, 0, 0, 0, 0, 0}, 1e-3));
  EXPECT_GT(arm.position()[0], 0.5);
  EXPECT_LT(std::abs(held), 0.02);
}

TEST_F(PumaArmTest, StopsAtAJointLimit) {
  load();
  ASSERT_TRUE(arm.place(kQr));
  for (int i = 0; i < 3000; ++i) ASSERT_TRUE(arm.step(PumaVector{0, 0, 0, 0, 20, 0}, 1e-3));
  EXPECT_NEAR(arm.position()[4], 100 * math::kPi / 180, 0.05);
}

TEST_F(PumaArmTest, ComesToRestAndStaysWhenLocallyStable) {
  load({.payload_mass = 3});
  ASSERT_TRUE(arm.place(kQs));
  for (int i = 0; i < 300; ++i) ASSERT_TRUE(arm.step(PumaVector{20, 90, 0, 5, 5, 5}, 1e-3));
  ASSERT_GT(std::abs(arm.velocity()[0]), 0.1);
  for (int i = 0; i < 2000; ++i) ASSERT_TRUE(arm.step_locally_stable(1e-3));
  PumaVector rest;
  for (std::size_t j = 0; j < kPumaJoints; ++j) {
    EXPECT_NEAR(arm.velocity()[j], 0, 1e-4);
    rest[j] = arm.position()[j];
  }
  for (int i = 0; i < 1000; ++i) ASSERT_TRUE(arm.step_locally_stable(1e-3));
  for (std::size_t j = 0; j < kPumaJoints; ++j) EXPECT_NEAR(arm.position()[j], rest[j], 1e-4);
}

TEST_F(PumaArmTest, BrakesStopEveryJoint) {
  load();
  ASSERT_TRUE(arm.place(kQr));
  ASSERT_TRUE(arm.step(PumaVector{50, 50, 50, 5, 5, 5}, 0.1));
  arm.brake();
  for (double v : arm.velocity()) EXPECT_EQ(v, 0);
}

TEST_F(PumaArmTest, RefusesATorqueThatIsNotANumberAndStaysAsItWas) {
  load();
  ASSERT_TRUE(arm.place(kQr));
  EXPECT_FALSE(arm.step(PumaVector{0, 0, std::nan(""), 0, 0, 0}, 1e-3));
  EXPECT_STREQ(arm.fault(), "tau[2] is not finite");
  EXPECT_EQ(arm.position()[1], kQr[1]);
}

TEST_F(PumaArmTest, RefusesATimeStepThatIsNotPositive) {
  load();
  EXPECT_FALSE(arm.step(PumaVector{}, 0));
  EXPECT_STREQ(arm.fault(), "the time step is not positive");
  EXPECT_FALSE(arm.step(PumaVector{}, -1e-3));
}

TEST_F(PumaArmTest, RefusesPayloadShareAndPoseOutsideTheirRange) {
  EXPECT_EQ(arm.load(model_path(), {.payload_mass = 11}).error().message.view(),
            "payload_mass is 11 kg, expected 0 to 10 kg");
  EXPECT_EQ(arm.load(model_path(), {.payload_mass = std::nan("")}).error().message.view(),
            "payload_mass is nan kg, expected 0 to 10 kg");
  EXPECT_EQ(arm.load(model_path(), {.coulomb_share = 2}).error().message.view(), "coulomb_share is 2, expected 0 to 1");
  load();
  EXPECT_EQ(arm.place(PumaVector{0, 0, 1, 0, 0, 0}).error().message.view(),
            "joint 3 at 1 rad is outside its limits -3.927 to 0.7854 rad");
}

TEST_F(PumaArmTest, BuiltInModelIsTheFile) {
  const std::string file = source_path("library/puma_torque/puma560.xml");
  const Result<void> loaded = arm.load(file.c_str(), {});
  ASSERT_TRUE(loaded) << loaded.error().message.view();
  expect_gravity(kQs, {0, 46.0069, 8.7722, 0, .0283, 0});
}

TEST_F(PumaArmTest, RefusesAFileThatIsNoSixJointArm) {
  EXPECT_NE(arm.load("no_such.xml", {}).error().message.view().find("no_such.xml: "), std::string_view::npos);
  const std::string path = testing::TempDir() + "one_joint_" + std::to_string(::getpid()) + ".xml";
  std::ofstream(path) << "<mujoco><worldbody><body><joint/><geom size='.1'/></body></worldbody></mujoco>";
  EXPECT_EQ(arm.load(path.c_str(), {}).error().message.view(),
            path + ": found 1 joints and 0 motors, expected 6 and 6");
  ::unlink(path.c_str());
}

TEST_F(PumaArmTest, LeavesNoLogFileBehind) {
  load();
  mju_warning("a warning that MuJoCo would write to MUJOCO_LOG.TXT");
  EXPECT_NE(access("MUJOCO_LOG.TXT", F_OK), 0);
}

TEST(MujocoGuard, TurnsAnErrorIntoAnAnswer) {
  install_mujoco_handlers();
  mjData state{};
  EXPECT_FALSE(guarded([](const mjModel*, mjData*) { mju_error("stack overflow"); }, nullptr, &state));
  EXPECT_STREQ(mujoco_error(), "stack overflow");
  EXPECT_TRUE(guarded([](const mjModel*, mjData*) {}, nullptr, &state));
  EXPECT_STREQ(mujoco_error(), "");
}

TEST(MujocoGuard, SeesASilentReset) {
  install_mujoco_handlers();
  mjData state{};
  EXPECT_FALSE(guarded([](const mjModel*, mjData* d) { d->warning[mjWARN_BADQVEL].number = 1; }, nullptr, &state));
}

}  // namespace
}  // namespace chimera::library
