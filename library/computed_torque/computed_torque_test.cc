// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "chimera/task/rig.h"
#include "library/kinematics/puma560.h"
#include "library/kinematics/testing/puma560_links.h"
#include "library/puma_torque/puma_arm.h"
#include "library/puma_torque/testing/puma_mechanics.h"

namespace chimera {
namespace {

using library::kPuma560Links;
using library::LinkMass;
using library::Puma560;
using library::PumaVector;

constexpr PumaVector kNominal{0, M_PI / 4, -M_PI / 2, 0.1, M_PI / 4, 0};
constexpr double kNotANumber = std::numeric_limits<double>::quiet_NaN();

struct ComputedTorqueTest : ::testing::Test {
  Rig rig{"computed_torque"};

  void SetUp() override {
    rig.set("ndof", std::int32_t{6});
    for (std::size_t i = 0; i < 6; ++i) {
      rig.set("dh", Puma560::kRows[i], i);
      rig.set("links", kPuma560Links[i], i);
      rig.set("tau_max", 190.0, i);
    }
    for (const char* port : {"qd_ref", "qdd_ref", "qd"}) give(port, PumaVector{});
    give("q_ref", kNominal);
    give("q", kNominal);
  }
  void give(const char* port, std::span<const double> values) {
    for (std::size_t i = 0; i < 6; ++i) rig.set(port, values[i], i);
  }
  PumaVector torque() {
    PumaVector found;
    for (std::size_t i = 0; i < 6; ++i) found[i] = rig.get<double>("tau", i);
    return found;
  }
  std::string refusal() {
    const RigAnswer answer = rig.init();
    return answer ? "accepted" : answer.text;
  }
  /// Largest tracking error (rad) in 2 s of a simulated arm, after 0.5 s of settling.
  double error_behind_an_arm(double payload) {
    library::PumaArm arm;
    EXPECT_TRUE(arm.load(library::kPumaModel, {.payload_mass = payload}));
    EXPECT_TRUE(arm.place(kNominal));
    double worst = 0;
    for (int step = 0; step < 2000; ++step) {
      const double t = step * 1e-3, w = 2;
      PumaVector position = kNominal, speed, acceleration;
      for (std::size_t i = 0; i < 6; ++i) {
        position[i] += 0.3 * (1 - std::cos(w * t));
        speed[i] = 0.3 * w * std::sin(w * t);
        acceleration[i] = 0.3 * w * w * std::cos(w * t);
      }
      give("q_ref", position), give("qd_ref", speed), give("qdd_ref", acceleration);
      give("q", arm.position()), give("qd", arm.velocity());
      if (step == 0) {
        EXPECT_TRUE(rig.on());
      }
      EXPECT_TRUE(rig.cycle());
      EXPECT_TRUE(arm.step(torque(), 1e-3)) << arm.fault();
      for (std::size_t i = 0; i < 6 && step > 500; ++i) {
        worst = std::max(worst, std::abs(arm.position()[i] - position[i]));
      }
    }
    return worst;
  }
};

TEST_F(ComputedTorqueTest, AContinuousJointTurnsTheShortWay) {
  rig.set("is_continuous", true, 0);
  ASSERT_TRUE(rig.init());
  PumaVector from = kNominal, to = kNominal;
  from[0] = 3.1, to[0] = -3.1;
  give("q", from), give("q_ref", to);
  ASSERT_TRUE(rig.on());
  const PumaVector over_the_end = torque();
  from[0] = 3.1 - 2 * M_PI;
  give("q", from);
  ASSERT_TRUE(rig.cycle());
  for (std::size_t i = 0; i < 6; ++i) EXPECT_NEAR(over_the_end[i], torque()[i], 1e-9) << "joint " << i;
  EXPECT_GT(std::abs(over_the_end[0]), 1) << "it moves";
}

TEST_F(ComputedTorqueTest, CarriesTheWeightAtRest) {
  ASSERT_TRUE(rig.init());
  ASSERT_TRUE(rig.on());
  library::PumaArm arm;
  ASSERT_TRUE(arm.load(library::kPumaModel, {}));
  ASSERT_TRUE(arm.place(kNominal));
  const PumaVector weight = library::bias_torque(arm), found = torque();
  for (std::size_t i = 0; i < 6; ++i) EXPECT_NEAR(found[i], weight[i], 1e-9);
}

TEST_F(ComputedTorqueTest, FollowsAsIfTheArmHadNoWeightAndNoFriction) {
  ASSERT_TRUE(rig.init());
  EXPECT_LT(error_behind_an_arm(0), 2e-3);
}

TEST_F(ComputedTorqueTest, AnUnknownPayloadShowsAndAKnownOneDoesNot) {
  ASSERT_TRUE(rig.init());
  EXPECT_GT(error_behind_an_arm(3), 8e-3);
  rig.set("payload_mass", 3.0);
  ASSERT_TRUE(rig.reinit());
  EXPECT_LT(error_behind_an_arm(3), 2e-3);
}

TEST_F(ComputedTorqueTest, AnErrorTakesTheTorqueOfItsAcceleration) {
  rig.set("bandwidth", 10.0);
  rig.set("gravity", 0.0, 2);
  ASSERT_TRUE(rig.init());
  PumaVector moved = kNominal;
  moved[5] += 0.2;
  give("q_ref", moved);
  ASSERT_TRUE(rig.cycle());
  EXPECT_NEAR(torque()[5], (kPuma560Links[5].rotor + kPuma560Links[5].inertia[2]) * 10 * 10 * 0.2, 1e-12);
}

TEST_F(ComputedTorqueTest, StaysWithinTheTorqueOfTheDrives) {
  rig.set("tau_max", 5.0, 1);
  ASSERT_TRUE(rig.init());
  ASSERT_TRUE(rig.cycle());
  EXPECT_EQ(rig.get<double>("tau", 1), 5);
}

TEST_F(ComputedTorqueTest, RefusesAnInputThatIsNotFiniteAndGoesOnAfterIt) {
  ASSERT_TRUE(rig.init());
  for (const char* port : {"q", "qd", "q_ref", "qd_ref", "qdd_ref"}) {
    rig.set(port, kNotANumber, 2);
    const RigAnswer answer = rig.cycle();
    EXPECT_FALSE(answer);
    EXPECT_EQ(answer.text, "an input is not finite");
    rig.set(port, 0.0, 2);
    EXPECT_TRUE(rig.cycle()) << port;
  }
}

TEST_F(ComputedTorqueTest, TheTorqueStandsWhileTheConfigurationIsIllegal) {
  ASSERT_TRUE(rig.init());
  ASSERT_TRUE(rig.on());
  const PumaVector before = torque();
  give("q", PumaVector{kNotANumber});
  rig.illegal(true);
  ASSERT_TRUE(rig.cycle());
  EXPECT_EQ(torque(), before);
}

TEST_F(ComputedTorqueTest, RefusesWrongConstants) {
  LinkMass link = kPuma560Links[3];
  link.mass = -1;
  rig.set("links", link, 3);
  EXPECT_EQ(refusal(), "links: mass, rotor and friction are 0 or more");
  link = kPuma560Links[3];
  link.inertia[1] = -1e-3;
  rig.set("links", link, 3);
  EXPECT_EQ(refusal(), "links: the inertia about an axis is 0 or more");
  link.inertia[1] = kNotANumber;
  rig.set("links", link, 3);
  EXPECT_EQ(refusal(), "links: a number is not finite");
  rig.set("links", kPuma560Links[3], 3);
  rig.set("tau_max", -1.0, 0);
  EXPECT_EQ(refusal(), "tau_max must be 0 N.m or more");
  rig.set("tau_max", 10.0, 0);
  rig.set("gravity", kNotANumber, 0);
  EXPECT_EQ(refusal(), "gravity is not finite");
}

}  // namespace
}  // namespace chimera
