// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <cmath>

#include "chimera/task/rig.h"

namespace chimera {
namespace {

struct PidJointTest : ::testing::Test {
  Rig rig{"pid_joint"};
  void give() {
    rig.set("ndof", std::int32_t{2});
    rig.set("filter_time", 0.0);
    for (std::size_t i = 0; i < 2; ++i) {
      rig.set("tau_max", 50.0, i);
      rig.set("kp", 100.0, i);
      rig.set("ki", 10.0, i);
      rig.set("kd", 5.0, i);
      for (const char* port : {"q_ref", "qd_ref", "q", "qd"}) rig.set(port, 0.0, i);
    }
  }
  void start() {
    give();
    ASSERT_TRUE(rig.init());
    ASSERT_TRUE(rig.on());
  }
};

TEST_F(PidJointTest, GivesTheThreeTermsForEachJointAlone) {
  start();
  rig.set("q_ref", 0.1, 0);
  rig.set("qd", -0.2, 1);
  ASSERT_TRUE(rig.cycle());
  EXPECT_DOUBLE_EQ(rig.get<double>("tau", 0), 100 * 0.1 + 10 * 0.1 * 1e-3);
  EXPECT_DOUBLE_EQ(rig.get<double>("tau", 1), 5 * 0.2);
}

TEST_F(PidJointTest, StaysWithinTheTorqueOfTheDrives) {
  start();
  rig.set("q_ref", 3.0, 0);
  ASSERT_TRUE(rig.cycle());
  EXPECT_EQ(rig.get<double>("tau", 0), 50);
}

TEST_F(PidJointTest, StartsAtItsLastTorque) {
  start();
  rig.set("q_ref", 0.2, 0);
  for (int i = 0; i < 500; ++i) ASSERT_TRUE(rig.cycle());
  const double stands = rig.get<double>("tau", 0);
  ASSERT_GT(stands, 20);
  ASSERT_TRUE(rig.off());
  rig.set("q", 0.15, 0);
  ASSERT_TRUE(rig.on());
  ASSERT_TRUE(rig.cycle());
  EXPECT_NEAR(rig.get<double>("tau", 0), stands, 1e-3);
}

TEST_F(PidJointTest, StartsAtAFreshHandedOverTorqueOnly) {
  start();
  rig.set("q_ref", 0.1, 0);
  rig.set("tau", 20.0, 0);
  rig.inherit("tau", milliseconds(2));
  ASSERT_TRUE(rig.on());
  EXPECT_EQ(rig.get<double>("tau", 0), 20);
  ASSERT_TRUE(rig.cycle());
  EXPECT_NEAR(rig.get<double>("tau", 0), 20 + 10 * 0.1 * 1e-3, 1e-12);
  rig.set("tau", 20.0, 0);
  rig.inherit("tau", milliseconds(20));
  ASSERT_TRUE(rig.on());
  EXPECT_EQ(rig.get<double>("tau", 0), 0);
  ASSERT_TRUE(rig.cycle());
  EXPECT_NEAR(rig.get<double>("tau", 0), 10 * 0.1 * 1e-3, 1e-12);
  rig.illegal(true);
  rig.set("tau", 5.0, 0);
  ASSERT_TRUE(rig.cycle());
  EXPECT_EQ(rig.get<double>("tau", 0), 5) << "that of on was old, that of this run is not";
}

TEST_F(PidJointTest, DoesNotIntegrateWhileTheConfigurationIsIllegal) {
  start();
  rig.illegal(true);
  rig.set("q_ref", 0.2, 0);
  for (int i = 0; i < 5000; ++i) ASSERT_TRUE(rig.cycle());
  EXPECT_EQ(rig.get<double>("tau", 0), 0);
  rig.illegal(false);
  ASSERT_TRUE(rig.cycle());
  EXPECT_NEAR(rig.get<double>("tau", 0), 0, 1e-2);
}

TEST_F(PidJointTest, InputThatIsNotANumberIsAFault) {
  start();
  rig.set("q", std::nan(""), 1);
  EXPECT_EQ(rig.cycle().text, "q[1] is not a finite number");
  EXPECT_TRUE(rig.error());
  rig.set("q", 0.1, 1);
  ASSERT_TRUE(rig.cycle()) << "the next good input continues";
  EXPECT_LT(rig.get<double>("tau", 1), 0);
}

TEST_F(PidJointTest, AwaitsAnInputThatWasNeverWritten) {
  Rig fresh("pid_joint");
  fresh.set("ndof", std::int32_t{1});
  fresh.set("tau_max", 50.0);
  for (const char* port : {"q_ref", "qd_ref", "q", "kp", "ki", "kd"}) fresh.set(port, 1.0);
  ASSERT_TRUE(fresh.init());
  ASSERT_TRUE(fresh.on());
  EXPECT_EQ(fresh.cycle().status, CHIMERA_ABORTED);
  fresh.set("qd", 1.0);
  ASSERT_TRUE(fresh.cycle());
  EXPECT_NEAR(fresh.get<double>("tau"), 0, 1e-2);
}

TEST_F(PidJointTest, AContinuousJointTurnsTheShortWay) {
  give();
  rig.set("is_continuous", true, 0);
  ASSERT_TRUE(rig.init());
  ASSERT_TRUE(rig.on());
  rig.set("q", 3.1, 0);
  rig.set("q_ref", -3.1, 0);
  ASSERT_TRUE(rig.cycle());
  EXPECT_NEAR(rig.get<double>("tau", 0), 100 * (2 * M_PI - 6.2), 1e-2);
}

TEST_F(PidJointTest, RefusesLimitsBeyondTheRangeOfTau) {
  give();
  rig.set("tau_max", 201.0, 1);
  EXPECT_EQ(rig.init().text, "tau_max must be 0 to 200 N.m, the range of tau");
}

TEST_F(PidJointTest, RefusesAFilterThatRunsBackwards) {
  give();
  rig.set("filter_time", -1e-3);
  EXPECT_EQ(rig.init().text, "filter_time must be 0 s or more");
  rig.set("filter_time", std::nan(""));
  EXPECT_EQ(rig.init().text, "filter_time must be 0 s or more");
}

}  // namespace
}  // namespace chimera
