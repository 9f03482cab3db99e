// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <cmath>

#include "chimera/task/rig.h"
#include "library/kinematics/puma560.h"

namespace chimera {
namespace {

using library::Puma560;
constexpr Puma560::Vector kStart{0, 1.5707963267948966, -1.5707963267948966, 0, 0, 0};

struct PumaTest : ::testing::Test {
  Rig rig{"puma"};
  void start() {
    for (std::size_t i = 0; i < 6; ++i) {
      rig.set("start_pose", kStart[i], i);
      rig.set("q_ref", kStart[i], i);
    }
    const RigAnswer made = rig.init();
    ASSERT_TRUE(made) << made.text;
    ASSERT_TRUE(rig.on());
  }
};

TEST_F(PumaTest, PublishesItsDhRows) {
  start();
  EXPECT_EQ(rig.get<std::int32_t>("ndof"), 6);
  EXPECT_EQ(rig.get<library::DhLink>("dh", 1).a, .4318);
  EXPECT_EQ(rig.get<library::DhLink>("dh", 5).d, .05625);
}

// An arm that replaces another starts at the place and speed of that arm, not in its start pose.
TEST_F(PumaTest, StartsAtTheStateOfTheTaskThatItReplaces) {
  start();
  const auto inherit = [&](Nanoseconds age, double elbow) {
    for (std::size_t i = 0; i < 6; ++i) {
      rig.set("q", kStart[i] + 0.1, i), rig.set("qd", 0.2, i), rig.set("q_ref", kStart[i] + 0.1, i);
    }
    rig.set("q", elbow, 2);
    for (const char* port : {"q", "qd"}) rig.inherit(port, age);
  };
  inherit(milliseconds(2), kStart[2] + 0.1);
  ASSERT_TRUE(rig.on());
  for (std::size_t i = 0; i < 6; ++i) {
    EXPECT_EQ(rig.get<double>("q", i), kStart[i] + 0.1);
    EXPECT_EQ(rig.get<double>("qd", i), 0.2);
  }
  ASSERT_TRUE(rig.cycle());
  EXPECT_NEAR(rig.get<double>("q", 0), kStart[0] + 0.1, 1e-3);
  EXPECT_NEAR(rig.get<double>("qd", 0), 0.2, 0.05);
  inherit(milliseconds(200), kStart[2] + 0.1);
  ASSERT_TRUE(rig.on());
  EXPECT_EQ(rig.get<double>("q", 0), kStart[0] + 0.1) << "it stands there";
  EXPECT_EQ(rig.get<double>("qd", 0), 0);
  inherit(milliseconds(2), 4.0);
  EXPECT_EQ(rig.on().text, "joint 3 cannot go on at 4 rad, 0.2 rad/s: it moves from -3.927 to 0.7854 rad");
  inherit(milliseconds(2), std::nan(""));
  EXPECT_FALSE(rig.on());
}

TEST_F(PumaTest, GoesToAPositionNoFasterThanAllowed) {
  start();
  rig.set("q_ref", 0.8, 0);
  rig.set("q_ref", 1.0, 1);
  for (int i = 0; i < 1500; ++i) {
    ASSERT_TRUE(rig.cycle());
    ASSERT_LT(std::abs(rig.get<double>("qd", 0)), 1.52);
  }
  EXPECT_NEAR(rig.get<double>("q", 0), 0.8, 1e-4);
  EXPECT_NEAR(rig.get<double>("q", 1), 1.0, 1e-4);
}

TEST_F(PumaTest, HoldsUnderAnotherPayloadAndWhileTheConfigurationIsIllegal) {
  start();
  rig.set("payload_mass", 3.0);
  ASSERT_TRUE(rig.reinit());
  ASSERT_TRUE(rig.on());
  rig.illegal(true);
  rig.set("q_ref", std::nan(""), 2);
  for (int i = 0; i < 300; ++i) ASSERT_TRUE(rig.cycle());
  for (std::size_t i = 0; i < 6; ++i) EXPECT_NEAR(rig.get<double>("q", i), kStart[i], 1e-3);
}

TEST_F(PumaTest, RefusesAReferenceThatIsNoNumberAndAPoseOutsideItsLimits) {
  start();
  rig.set("q_ref", std::nan(""), 2);
  EXPECT_EQ(rig.cycle().text, "q_ref[2] is not finite");
  EXPECT_FALSE(rig.error());
  EXPECT_TRUE(rig.clear());
  rig.set("start_pose", 9.0, 3);
  EXPECT_EQ(rig.init().text, "joint 4 at 9 rad is outside its limits -1.92 to 2.967 rad");
}

TEST_F(PumaTest, RefusesAPayloadThatItCannotCarry) {
  rig.set("payload_mass", 10.5);
  EXPECT_EQ(rig.init().text, "payload_mass is 10.5 kg, expected 0 to 10 kg");
}

}  // namespace
}  // namespace chimera
