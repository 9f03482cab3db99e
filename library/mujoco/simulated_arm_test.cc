// SPDX-License-Identifier: Apache-2.0
#include "library/mujoco/simulated_arm.h"

#include <gtest/gtest.h>
#include <mujoco/mujoco.h>
#include <unistd.h>

#include <cmath>
#include <fstream>
#include <string>
#include <vector>

namespace chimera::library {
namespace {

using Numbers = std::vector<double>;

// Two links of a metre in a vertical plane, a sliding gripper and a free ball.
constexpr char kTwoLinks[] = R"(<mujoco><compiler angle="radian"/><worldbody>
  <body name="ball" pos="3 0 1"><freejoint/><geom size=".1"/></body>
  <body name="upper"><joint name="shoulder" axis="0 1 0" limited="true" range="-2 2"/>
    <geom type="capsule" fromto="0 0 0 1 0 0" size=".05" contype="0" conaffinity="0"/>
    <body name="lower" pos="1 0 0"><joint name="elbow" axis="0 1 0"/>
      <geom type="capsule" fromto="0 0 0 1 0 0" size=".04" contype="0" conaffinity="0"/>
      <site name="tip" pos="1 0 0"/>
      <body name="finger" pos="1 0 0"><joint type="slide" axis="0 1 0"/>
        <geom size=".02" contype="0" conaffinity="0"/></body>
    </body></body></worldbody>
  <actuator><motor joint="shoulder" gear="50" ctrllimited="true" ctrlrange="-2 2"/>
    <position joint="elbow" kp="1000" forcelimited="true" forcerange="-40 40"/></actuator></mujoco>)";

struct SimulatedArmTest : ::testing::Test {
  std::string path = testing::TempDir() + "arm_" + std::to_string(::getpid()) + ".xml";
  SimulatedArm arm;

  ~SimulatedArmTest() override { ::unlink(path.c_str()); }
  Result<void> load(const std::string& text, const char* tip = "") {
    std::ofstream(path) << text;
    return arm.load(path.c_str(), tip);
  }
  std::string refusal(const std::string& text, const char* tip = "") {
    const Result<void> loaded = load(text, tip);
    if (loaded) return "loaded";
    std::string said(loaded.error().message.view());
    return said.starts_with(path) ? said.substr(path.size()) : said;
  }
  void run(ArmInterface interface, const Numbers& command, double seconds) {
    for (double t = 0; t < seconds; t += 1e-3) ASSERT_TRUE(arm.step(interface, command, 1e-3)) << arm.fault();
  }
};

TEST_F(SimulatedArmTest, TheArmIsTheHingesToTheTip) {
  ASSERT_TRUE(load(kTwoLinks, "tip"));
  EXPECT_EQ(arm.joints(), 2u);
  EXPECT_EQ(arm.arm().low[0], -2);
  EXPECT_EQ(arm.arm().high[0], 2);
  EXPECT_EQ(arm.arm().high[1], kNoModelLimit);
  EXPECT_EQ(arm.arm().torque_limit[0], 100);
  EXPECT_EQ(arm.arm().torque_limit[1], 40);
  const Numbers q{0.3, -0.8};
  const Frame tool = tool_frame(arm.arm().chain, q);
  EXPECT_NEAR(tool.origin[0], std::cos(0.3) + std::cos(0.5), 1e-9);
  EXPECT_NEAR(tool.origin[2], -std::sin(0.3) + std::sin(0.5), 1e-9);
}

TEST_F(SimulatedArmTest, ItsConstantsSayWhereMujocoHasTheTip) {
  ASSERT_TRUE(load(kTwoLinks, "tip"));
  for (const Numbers& q : {Numbers{0, 0}, {1, 1}, {-1.5, 2.5}}) {
    ASSERT_TRUE(arm.place(q));
    const Frame tool = tool_frame(arm.arm().chain, q);
    for (std::size_t i = 0; i < 3; ++i) EXPECT_NEAR(tool.origin[i], arm.state()->site_xpos[i], 1e-9);
    for (std::size_t i = 0; i < 3; ++i) EXPECT_NEAR(tool.x[i], arm.state()->site_xmat[3 * i], 1e-9);
  }
}

TEST_F(SimulatedArmTest, PositionDrivesArriveWithoutOvershootUnderGravity) {
  ASSERT_TRUE(load(kTwoLinks));
  arm.limit_torque(Numbers{900, 900});
  double furthest = 0;
  for (int i = 0; i < 1500; ++i) {
    ASSERT_TRUE(arm.step(ArmInterface::kPosition, Numbers{-0.5, 1}, 1e-3));
    furthest = std::max(furthest, arm.position()[1]);
    EXPECT_LT(std::abs(arm.velocity()[1]), 3.1);
  }
  EXPECT_NEAR(arm.position()[0], -0.5, 1e-4);
  EXPECT_NEAR(arm.position()[1], 1, 1e-4);
  EXPECT_LT(furthest, 1.001);
}

TEST_F(SimulatedArmTest, APositionBeyondALimitIsCutThere) {
  ASSERT_TRUE(load(kTwoLinks));
  arm.limit_torque(Numbers{900, 900});
  run(ArmInterface::kPosition, {-2.6, 0}, 2);
  EXPECT_NEAR(arm.position()[0], -2, 2e-3);
}

TEST_F(SimulatedArmTest, AVelocityIsHeldAndStopsBeforeALimit) {
  ASSERT_TRUE(load(kTwoLinks));
  arm.limit_torque(Numbers{900, 900});
  run(ArmInterface::kVelocity, {-0.5, 0.25}, 1);
  EXPECT_NEAR(arm.velocity()[0], -0.5, 1e-3);
  EXPECT_NEAR(arm.velocity()[1], 0.25, 1e-3);
  run(ArmInterface::kVelocity, {-0.5, 0}, 5);
  EXPECT_NEAR(arm.position()[0], -2, 5e-3);
  EXPECT_NEAR(arm.velocity()[0], 0, 1e-3);
}

TEST_F(SimulatedArmTest, DrivesThatAreTooWeakDoNotArrive) {
  ASSERT_TRUE(load(kTwoLinks));
  arm.limit_torque(Numbers{1, 1});
  run(ArmInterface::kPosition, {-0.5, 1}, 1.5);
  EXPECT_GT(arm.position()[0], 0.5);
}

TEST_F(SimulatedArmTest, HoldsWithoutACommandWhereItIs) {
  ASSERT_TRUE(load(kTwoLinks));
  run(ArmInterface::kTorque, {0, 0}, 0.2);
  ASSERT_GT(arm.velocity()[0], 0.5);
  for (int i = 0; i < 2000; ++i) ASSERT_TRUE(arm.step_locally_stable(1e-3));
  const double rest = arm.position()[0];
  for (int i = 0; i < 500; ++i) ASSERT_TRUE(arm.step_locally_stable(1e-3));
  EXPECT_NEAR(arm.position()[0], rest, 1e-3);
}

TEST_F(SimulatedArmTest, ReadsAUrdf) {
  ASSERT_TRUE(load(R"(<robot name="r"><link name="l0"/>
    <link name="l1"><inertial><mass value="2"/><origin xyz=".5 0 0"/>
      <inertia ixx=".1" iyy=".1" izz=".1" ixy="0" ixz="0" iyz="0"/></inertial></link>
    <joint name="j1" type="revolute"><parent link="l0"/><child link="l1"/><origin xyz="0 0 .3"/><axis xyz="0 0 1"/>
      <limit lower="-1" upper="1.5" effort="10" velocity="2"/></joint></robot>)"));
  EXPECT_EQ(arm.joints(), 1u);
  EXPECT_EQ(arm.arm().low[0], -1);
  EXPECT_EQ(arm.arm().high[0], 1.5);
}

TEST_F(SimulatedArmTest, RefusesAModelWithoutAnArm) {
  EXPECT_EQ(refusal("<mujoco><worldbody/></mujoco>"), ": found no joint that turns a link of an arm");
  EXPECT_EQ(refusal(kTwoLinks, "toes"), ": there is no body and no site 'toes'");
  EXPECT_EQ(refusal(kTwoLinks, "finger"), ": joint 'without a name' is no hinge: an arm has hinges only");
  std::string bodies, ends;
  for (int i = 0; i < 11; ++i) {
    bodies += "<body pos='1 0 0'><joint axis='0 1 0'/><geom size='.1'/>";
    ends += "</body>";
  }
  EXPECT_EQ(refusal("<mujoco><worldbody>" + bodies + ends + "</worldbody></mujoco>"),
            ": found 11 joints, expected at most 10");
  EXPECT_EQ(refusal("<mujoco><worldbody><bdy/></worldbody></mujoco>"),
            ": XML Error: Schema violation: unrecognized element Element 'bdy', line 1");
  EXPECT_EQ(arm.load("no_such.xml").error().message.view(), "no_such.xml: cannot be read, or there is nothing in it");
}

TEST_F(SimulatedArmTest, RefusesAUrdfFileWhoseLimitsAreNotInOrder) {
  const std::string mass =
      "<inertial><mass value='1'/><inertia ixx='1' iyy='1' izz='1' ixy='0' ixz='0' iyz='0'/></inertial>";
  const auto urdf = [&mass](const char* lower) {
    return "<robot name='r'><link name='a'/><link name='b'>" + mass + "</link><joint name='j' type='revolute'>" +
           "<parent link='a'/><child link='b'/><axis xyz='0 1 0'/><limit lower='" + lower +
           "' upper='1' effort='1' velocity='1'/></joint></robot>";
  };
  EXPECT_EQ(refusal(urdf("-1")), "loaded");
  EXPECT_EQ(refusal(urdf("2")), ": the lower limit of joint 'j' is above its upper one");
}

TEST_F(SimulatedArmTest, RefusesACommandOfAnotherSizeOrNoNumber) {
  ASSERT_TRUE(load(kTwoLinks));
  EXPECT_FALSE(arm.step(ArmInterface::kPosition, Numbers{0, 0, 0}, 1e-3));
  EXPECT_STREQ(arm.fault(), "q_ref has 3 elements, but the arm 2 joints");
  EXPECT_FALSE(arm.step(ArmInterface::kVelocity, Numbers{0, std::nan("")}, 1e-3));
  EXPECT_STREQ(arm.fault(), "qd_ref[1] is not finite");
  EXPECT_EQ(arm.place(Numbers{0}).error().message.view(), "a pose of 1 joints, but the arm has 2");
}

TEST_F(SimulatedArmTest, StandsAsBeforeWhenTheSimulationBlowsUp) {
  ASSERT_TRUE(load(kTwoLinks));
  run(ArmInterface::kPosition, {-0.2, 0.1}, 0.5);
  const double before = arm.position()[0];
  arm.limit_torque(Numbers{1e300, 1e300});
  EXPECT_FALSE(arm.step(ArmInterface::kTorque, Numbers{1e200, -1e200}, 1e-3));
  EXPECT_STREQ(arm.fault(), "the simulated arm blew up: its state is not a number");
  EXPECT_EQ(arm.position()[0], before);
  EXPECT_TRUE(arm.step(ArmInterface::kPosition, Numbers{-0.2, 0.1}, 1e-3));
}

}  // namespace
}  // namespace chimera::library
