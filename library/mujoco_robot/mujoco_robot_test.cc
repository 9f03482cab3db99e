// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>
#include <unistd.h>

#include <cmath>
#include <fstream>
#include <string>
#include <utility>

#include "chimera/task/rig.h"
#include "library/kinematics/dh_dynamics.h"

namespace chimera {
namespace {

// A robot of two joints from a file of the user, for all three interfaces.
struct RobotTest : ::testing::Test {
  std::string path = testing::TempDir() + "robot_" + std::to_string(::getpid()) + ".xml";
  RobotTest() {
    std::ofstream(path) << R"(<mujoco><compiler angle="radian"/><worldbody>
      <body><joint axis="0 1 0" limited="true" range="-2 2"/><geom size=".1" pos=".5 0 0" contype="0"/>
      <body pos=".5 0 0"><joint axis="0 1 0"/><geom size=".05" pos=".5 0 0" contype="0"/></body></body>
      </worldbody></mujoco>)";
  }
  ~RobotTest() override { ::unlink(path.c_str()); }
  void give(Rig& rig, const char* command) {
    rig.resource("model", path.c_str());
    for (std::size_t i = 0; i < 10; ++i) rig.set(command, 0.0, i);
  }
  void start(Rig& rig, const char* command) {
    give(rig, command);
    const RigAnswer made = rig.init();
    ASSERT_TRUE(made) << made.text;
    ASSERT_TRUE(rig.on());
  }
};

TEST_F(RobotTest, PublishesItsGeometryAtInit) {
  Rig rig("mujoco_robot");
  start(rig, "q_ref");
  EXPECT_EQ(rig.get<std::int32_t>("ndof"), 2);
  EXPECT_EQ(rig.get<double>("q_max", 0), 2);
  EXPECT_EQ(rig.get<double>("q_max", 1), 1e6);
  EXPECT_EQ(rig.get<double>("tau_max", 0), 1e6);
}

TEST_F(RobotTest, GoesToAPosition) {
  Rig rig("mujoco_robot");
  start(rig, "q_ref");
  rig.set("q_ref", 0.7, 0);
  rig.set("q_ref", -0.4, 1);
  for (int i = 0; i < 1000; ++i) ASSERT_TRUE(rig.cycle());
  EXPECT_NEAR(rig.get<double>("q", 0), 0.7, 1e-4);
  EXPECT_NEAR(rig.get<double>("q", 1), -0.4, 1e-4);
}

TEST_F(RobotTest, HoldsAVelocity) {
  Rig rig("mujoco_robot_velocity");
  start(rig, "qd_ref");
  rig.set("qd_ref", 0.5, 1);
  for (int i = 0; i < 500; ++i) ASSERT_TRUE(rig.cycle());
  EXPECT_NEAR(rig.get<double>("qd", 1), 0.5, 1e-3);
  EXPECT_NEAR(rig.get<double>("q", 1), 0.25, 0.03);
}

TEST_F(RobotTest, FallsWithoutTorque) {
  Rig rig("mujoco_robot_torque");
  start(rig, "tau");
  for (int i = 0; i < 100; ++i) ASSERT_TRUE(rig.cycle());
  EXPECT_GT(rig.get<double>("q", 0), 0.02);
}

TEST_F(RobotTest, ARobotThatTakesTorquesPublishesTheMassesOfItsLinks) {
  Rig rig("mujoco_robot_torque");
  start(rig, "tau");
  const auto link = rig.get<library::LinkMass>("links", 1);  // a sphere of water beside an axis along y
  EXPECT_NEAR(link.mass, 1000 * 4.0 / 3 * M_PI * 0.05 * 0.05 * 0.05, 1e-9);
  EXPECT_NEAR(library::length({link.centre[0], link.centre[1], link.centre[2]}), 0.5, 1e-9);
}

TEST_F(RobotTest, IgnoresItsCommandWhileTheConfigurationIsIllegal) {
  Rig rig("mujoco_robot");
  start(rig, "q_ref");
  rig.illegal(true);
  rig.set("q_ref", std::nan(""), 0);
  for (int i = 0; i < 300; ++i) ASSERT_TRUE(rig.cycle());
  EXPECT_NEAR(rig.get<double>("q", 0), 0, 2e-2);
  EXPECT_TRUE(rig.get<bool>("held"));
  rig.illegal(false);
  rig.set("q_ref", 0.0, 0);
  ASSERT_TRUE(rig.cycle());
  EXPECT_FALSE(rig.get<bool>("held"));
}

TEST_F(RobotTest, ACommandThatIsNotANumberIsAFaultAndBrakes) {
  Rig rig("mujoco_robot_torque");
  start(rig, "tau");
  for (int i = 0; i < 100; ++i) ASSERT_TRUE(rig.cycle());
  rig.set("tau", std::nan(""), 1);
  const RigAnswer answer = rig.cycle();
  EXPECT_FALSE(answer);
  EXPECT_EQ(answer.text, "tau[1] is not finite");
  EXPECT_FALSE(rig.error());
  EXPECT_EQ(rig.get<double>("qd", 0), 0);
  EXPECT_TRUE(rig.clear());
}

TEST_F(RobotTest, ReinitTakesOtherLimitsWhereItStands) {
  Rig rig("mujoco_robot");
  start(rig, "q_ref");
  rig.set("q_ref", 0.3, 0);
  for (int i = 0; i < 500; ++i) ASSERT_TRUE(rig.cycle());
  rig.set("torque_limit", 5.0, 0);
  ASSERT_TRUE(rig.reinit());
  ASSERT_TRUE(rig.on());
  EXPECT_NEAR(rig.get<double>("q", 0), 0.3, 1e-3);
  EXPECT_EQ(rig.get<double>("tau_max", 0), 5);
}

TEST_F(RobotTest, StartsAtTheStateOfTheTaskThatItReplaces) {
  constexpr std::pair<const char*, const char*> kRobots[] = {
      {"mujoco_robot", "q_ref"}, {"mujoco_robot_velocity", "qd_ref"}, {"mujoco_robot_torque", "tau"}};
  for (const auto& [component, command] : kRobots) {
    SCOPED_TRACE(component);
    Rig rig(component);
    start(rig, command);
    rig.set("q", 0.4, 0), rig.set("q", -0.3, 1), rig.set("qd", 0.5, 0), rig.set("qd", 0.0, 1);
    for (const char* port : {"q", "qd"}) rig.inherit(port, milliseconds(2));
    ASSERT_TRUE(rig.on());
    EXPECT_EQ(rig.get<double>("q", 0), 0.4);
    EXPECT_EQ(rig.get<double>("qd", 0), 0.5);
    ASSERT_TRUE(rig.cycle());
    EXPECT_NEAR(rig.get<double>("q", 0), 0.4, 1e-3);
    EXPECT_NEAR(rig.get<double>("q", 1), -0.3, 1e-3);
  }
}

TEST_F(RobotTest, RefusesAPoseOutsideTheLimitsAndAFileThatIsNotThere) {
  Rig rig("mujoco_robot");
  give(rig, "q_ref");
  rig.set("start_pose", 2.5, 0);
  EXPECT_EQ(rig.init().text, "joint 1 at 2.5 rad is outside its limits -2 to 2 rad");
  rig.resource("model", "no_such_robot.urdf");
  const std::string said = rig.init().text;
  EXPECT_TRUE(said.starts_with("no_such_robot.urdf: ")) << said;
}

}  // namespace
}  // namespace chimera
