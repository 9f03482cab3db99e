// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "chimera/task/rig.h"

namespace chimera {
namespace {

struct JointTrajectoryTest : ::testing::Test {
  Rig rig{"joint_trajectory"};
  void give(double duration) {
    rig.set("ndof", std::int32_t{2});
    rig.set("start_pose", 0.5, 0);
    rig.set("start_pose", -1.0, 1);
    rig.set("goal", 1.5, 0);
    rig.set("goal", -1.0, 1);
    rig.set("duration", duration);
    rig.set("profile", Text<16>("quintic"));
    rig.set("is_synchronised", true);
    for (std::size_t i = 0; i < 2; ++i) {
      rig.set("velocity_max", 1.0, i);
      rig.set("acceleration_max", 2.0, i);
      rig.set("jerk_max", 20.0, i);
    }
  }
  void start() {
    give(2.0);
    ASSERT_TRUE(rig.init());
    ASSERT_TRUE(rig.on());
  }
};

TEST_F(JointTrajectoryTest, StartsAtRestInItsStartPose) {
  start();
  EXPECT_EQ(rig.size("q_ref"), 2u);
  EXPECT_EQ(rig.get<double>("q_ref", 0), 0.5);
  EXPECT_EQ(rig.get<double>("qd_ref", 0), 0);
}

TEST_F(JointTrajectoryTest, PassesHalfwayAtItsPeakAndHoldsTheGoal) {
  start();
  for (int i = 0; i < 1000; ++i) ASSERT_TRUE(rig.cycle());
  EXPECT_NEAR(rig.get<double>("q_ref", 0), 1.0, 1e-9);
  EXPECT_NEAR(rig.get<double>("qd_ref", 0), 1.875 * 1.0 / 2, 1e-9);
  EXPECT_EQ(rig.get<double>("q_ref", 1), -1.0);
  for (int i = 0; i < 1500; ++i) ASSERT_TRUE(rig.cycle());
  EXPECT_EQ(rig.get<double>("q_ref", 0), 1.5);
  EXPECT_EQ(rig.get<double>("qd_ref", 0), 0);
  EXPECT_EQ(rig.get<double>("qdd_ref", 0), 0);
}

TEST_F(JointTrajectoryTest, StartsAgainFromTheReferenceThatStands) {
  start();
  for (int i = 0; i < 700; ++i) ASSERT_TRUE(rig.cycle());
  const double stands = rig.get<double>("q_ref", 0);
  ASSERT_TRUE(rig.off());
  EXPECT_EQ(rig.get<double>("qd_ref", 0), 0);
  ASSERT_TRUE(rig.on());
  EXPECT_EQ(rig.get<double>("q_ref", 0), stands);
}

// A predecessor in motion: each profile continues with its velocity and acceleration.
TEST_F(JointTrajectoryTest, StartsAtTheHandedOverMotion) {
  for (const char* profile : {"quintic", "jerk", "trapezoid"}) {
    SCOPED_TRACE(profile);
    give(2.0);
    rig.set("profile", Text<16>(profile));
    rig.set("goal", -2.0, 0);
    ASSERT_TRUE(rig.init());
    rig.set("q_ref", 0.6, 0), rig.set("qd_ref", 0.9, 0), rig.set("qdd_ref", 1.5, 0);
    rig.set("q_ref", -1.0, 1), rig.set("qd_ref", -0.2, 1), rig.set("qdd_ref", 0.0, 1);
    for (const char* port : {"q_ref", "qd_ref", "qdd_ref"}) rig.inherit(port, milliseconds(2));
    ASSERT_TRUE(rig.on());
    EXPECT_EQ(rig.get<double>("q_ref", 0), 0.6);
    EXPECT_NEAR(rig.get<double>("qd_ref", 0), 0.9, 1e-12);
    double last[2][2] = {{0.6, 0.9}, {-1.0, -0.2}};
    for (int k = 0; k < 12000; ++k) {
      ASSERT_TRUE(rig.cycle());
      for (std::size_t i = 0; i < 2; ++i) {
        const double q = rig.get<double>("q_ref", i), qd = rig.get<double>("qd_ref", i);
        ASSERT_NEAR(q, last[i][0] + (qd + last[i][1]) / 2 * 1e-3, 5e-6) << k;
        ASSERT_LE(std::abs(qd - last[i][1]), 12e-3) << k;
        last[i][0] = q, last[i][1] = qd;
      }
    }
    EXPECT_EQ(last[0][0], -2.0);
    EXPECT_EQ(last[0][1], 0);
    EXPECT_EQ(last[1][0], -1.0);
  }
}

TEST_F(JointTrajectoryTest, AVelocityThatIsOutdatedIsNotFollowed) {
  give(2.0);
  ASSERT_TRUE(rig.init());
  rig.set("q_ref", 0.6, 0), rig.set("qd_ref", 0.9, 0);
  for (const char* port : {"q_ref", "qd_ref", "qdd_ref"}) rig.inherit(port, milliseconds(20));
  ASSERT_TRUE(rig.on());
  EXPECT_EQ(rig.get<double>("q_ref", 0), 0.6);
  EXPECT_EQ(rig.get<double>("qd_ref", 0), 0);
}

TEST_F(JointTrajectoryTest, StartsInTheMeasuredMotionAndKeepsItsLimits) {
  give(0);
  rig.set("profile", Text<16>("jerk"));
  rig.set("q", -0.4, 0), rig.set("q", 0.2, 1), rig.set("qd", 0.6, 0), rig.set("qd", 0.0, 1);
  ASSERT_TRUE(rig.init());
  ASSERT_TRUE(rig.on());
  EXPECT_EQ(rig.get<double>("q_ref", 0), -0.4);
  EXPECT_EQ(rig.get<double>("q_ref", 1), 0.2);
  double before = 0.6;
  for (int k = 0; k < 8000; ++k) {
    ASSERT_TRUE(rig.cycle());
    const double qd = rig.get<double>("qd_ref", 0);
    ASSERT_LE(std::abs(qd), 1 + 1e-9);
    ASSERT_LE(std::abs(qd - before), 2e-3 * (1 + 1e-9));
    before = qd;
  }
  EXPECT_EQ(rig.get<double>("q_ref", 0), 1.5);
  EXPECT_TRUE(rig.notes().empty());
}

TEST_F(JointTrajectoryTest, NamesAStartBeyondItsLimits) {
  give(0);
  rig.set("profile", Text<16>("jerk"));
  ASSERT_TRUE(rig.init());
  rig.set("q_ref", 0.6, 0), rig.set("qd_ref", 0.4, 0), rig.set("qdd_ref", 5.1, 0);
  rig.set("q_ref", 0.0, 1), rig.set("qd_ref", 0.0, 1), rig.set("qdd_ref", 0.0, 1);
  for (const char* port : {"q_ref", "qd_ref", "qdd_ref"}) rig.inherit(port, milliseconds(2));
  ASSERT_TRUE(rig.on());
  ASSERT_EQ(rig.notes().size(), 1u);
  EXPECT_EQ(rig.notes()[0], "joint 1 starts at 0.4 rad/s, 5.1 rad/s2, beyond its limits 1 and 2: brakes first, may "
                            "pass the goal");
}

TEST_F(JointTrajectoryTest, AContinuousJointTakesTheShortWay) {
  give(2.0);
  rig.set("is_continuous", true, 0);
  rig.set("start_pose", 3.1, 0);
  rig.set("goal", -3.1, 0);
  ASSERT_TRUE(rig.init());
  ASSERT_TRUE(rig.on());
  for (int i = 0; i < 2001; ++i) {
    ASSERT_TRUE(rig.cycle());
    ASSERT_GE(rig.get<double>("q_ref", 0), 3.1);
  }
  EXPECT_NEAR(rig.get<double>("q_ref", 0), 2 * M_PI - 3.1, 1e-12);
}

TEST_F(JointTrajectoryTest, RefusesADurationOfNothingAndAGoalThatIsNotFinite) {
  give(0);
  EXPECT_EQ(rig.init().text, "duration must be above 0 s");
  give(1);
  rig.set("goal", std::nan(""), 1);
  EXPECT_EQ(rig.init().text, "start_pose and goal must be finite");
}

// Ten joints with random targets and limits: every sample is within the limits, and all joints reach the goal exactly
// and in the same cycle.
TEST(JointTrajectory, KeepsItsLimitsAndArrivesTogether) {
  std::mt19937_64 random(11);
  std::uniform_real_distribution<double> place(-3, 3), limit(0.5, 5);
  for (int n = 0; n < 40; ++n) {
    Rig rig("joint_trajectory");
    rig.set("ndof", 10);
    rig.set("duration", 0.0);
    rig.set("profile", Text<16>(n % 2 == 0 ? "jerk" : "trapezoid"));
    rig.set("is_synchronised", true);
    double goal[10], most[10][3];
    for (std::size_t i = 0; i < 10; ++i) {
      rig.set("start_pose", place(random), i);
      rig.set("goal", goal[i] = place(random), i);
      rig.set("velocity_max", most[i][0] = limit(random), i);
      rig.set("acceleration_max", most[i][1] = limit(random), i);
      rig.set("jerk_max", most[i][2] = 4 * limit(random), i);
    }
    ASSERT_TRUE(rig.init());
    ASSERT_TRUE(rig.on());
    double last[10] = {};
    bool is_there = false;
    int cycles = 0;
    for (; !is_there && cycles < 3000; ++cycles) {
      ASSERT_TRUE(rig.cycle(milliseconds(10)));
      int there = 0;
      for (std::size_t i = 0; i < 10; ++i) {
        const double a = rig.get<double>("qdd_ref", i);
        ASSERT_LE(std::abs(rig.get<double>("qd_ref", i)), most[i][0] * (1 + 1e-9)) << "seed 11, motion " << n;
        ASSERT_LE(std::abs(a), most[i][1] * (1 + 1e-9)) << "seed 11, motion " << n;
        if (n % 2 == 0) {
          ASSERT_LE(std::abs(a - last[i]), most[i][2] * 0.01 * (1 + 1e-6));
        }
        last[i] = a;
        there += rig.get<double>("q_ref", i) == goal[i] && rig.get<double>("qd_ref", i) == 0 ? 1 : 0;
      }
      ASSERT_TRUE(there == 0 || there == 10) << "seed 11, motion " << n;
      is_there = there == 10;
    }
    ASSERT_TRUE(is_there);
  }
}

TEST_F(JointTrajectoryTest, UnsynchronisedEachJointIsAsFastAsItsLimitsAllow) {
  give(0);
  rig.set("profile", Text<16>("trapezoid"));
  rig.set("is_synchronised", false);
  rig.set("goal", 3.0, 1);  // 1 rad and 4 rad: 1.5 s and 4.5 s
  ASSERT_TRUE(rig.init());
  ASSERT_TRUE(rig.on());
  ASSERT_TRUE(rig.cycle(milliseconds(1501)));
  EXPECT_EQ(rig.get<double>("q_ref", 0), 1.5);
  EXPECT_NE(rig.get<double>("q_ref", 1), 3.0);
  ASSERT_TRUE(rig.cycle(milliseconds(3000)));
  EXPECT_EQ(rig.get<double>("q_ref", 1), 3.0);
}

TEST_F(JointTrajectoryTest, WithLimitsADurationIsTheLeastTime) {
  give(7);
  rig.set("profile", Text<16>("jerk"));
  ASSERT_TRUE(rig.init());
  ASSERT_TRUE(rig.on());
  ASSERT_TRUE(rig.cycle(milliseconds(6999)));
  EXPECT_NE(rig.get<double>("q_ref", 0), 1.5);
  ASSERT_TRUE(rig.cycle(milliseconds(2)));
  EXPECT_EQ(rig.get<double>("q_ref", 0), 1.5);
}

TEST_F(JointTrajectoryTest, RefusesLimitsOfNothingAndAnUnknownProfile) {
  give(1);
  rig.set("profile", Text<16>("cubic"));
  EXPECT_EQ(rig.init().text, "profile must be quintic, trapezoid or jerk");
  for (double bad : {0.0, -1.0, std::nan("")}) {
    give(1);
    rig.set("profile", Text<16>("jerk"));
    rig.set("jerk_max", bad, 1);
    EXPECT_EQ(rig.init().text, "velocity_max, acceleration_max and jerk_max must be above 0");
  }
}

}  // namespace
}  // namespace chimera
