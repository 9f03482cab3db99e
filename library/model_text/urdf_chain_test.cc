// SPDX-License-Identifier: Apache-2.0
#include "library/model_text/urdf_chain.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include <cmath>
#include <fstream>
#include <string>
#include <vector>

#include "chimera/base/testing/tree_path.h"
#include "chimera/base/math.h"
#include "chimera/task/rig.h"
#include "library/mujoco/simulated_arm.h"

namespace chimera::library {
namespace {

std::string shipped_urdf(const std::string& file) { return source_path("library/urdf_model/" + file); }

struct UrdfChainTest : ::testing::Test {
  std::string path = testing::TempDir() + "chain_" + std::to_string(::getpid()) + ".urdf";
  ~UrdfChainTest() override { ::unlink(path.c_str()); }
  /// Reads two links with the joint `joint` between them.
  std::string refusal(const std::string& joint, const char* tip = "") {
    std::ofstream(path) << "<robot name='r'><link name='a'/><link name='b'/>" + joint + "</robot>";
    const Result<UrdfChain> found = read_urdf(path, tip);
    return found ? "read" : std::string(found.error().message.view()).substr(path.size());
  }
};

TEST_F(UrdfChainTest, ThePumasFlangeStandsWhereItIsPublished) {
  const Result<UrdfChain> puma = read_urdf(shipped_urdf("puma560.urdf"), "");
  ASSERT_TRUE(puma) << puma.error().message.view();
  ASSERT_EQ(puma->chain.ndof, 6u);
  // Wrist centres of Corke and Armstrong-Helouvry, and the flange 56.25 mm further along z of frame 6.
  const Result<UrdfChain> wrist = read_urdf(shipped_urdf("puma560.urdf"), "link6");
  const struct {
    std::vector<double> q;
    Vec3 p;
  } published[] = {{{0, 0, 0, 0, 0, 0}, {.4521, -.15005, .4318}},
                   {{0, math::kPi / 2, -math::kPi / 2, 0, 0, 0}, {.0203, -.15005, .8636}},
                   {{0, 0, -math::kPi / 2, 0, 0, 0}, {.8636, -.15005, -.0203}},
                   {{0, math::kPi / 4, -math::kPi, 0, math::kPi / 4, 0}, {.5963, -.15005, -.01435}}};
  for (const auto& [q, p] : published) {
    const Frame frame = tool_frame(wrist->chain, q), flange = tool_frame(puma->chain, q);
    for (std::size_t i = 0; i < 3; ++i) EXPECT_NEAR(frame.origin[i], p[i], 6e-5);
    for (std::size_t i = 0; i < 3; ++i) EXPECT_NEAR(flange.origin[i], p[i] + .05625 * frame.z[i], 6e-5);
  }
}

TEST_F(UrdfChainTest, ReadsNamesAndLimits) {
  const Result<UrdfChain> puma = read_urdf(shipped_urdf("puma560.urdf"), "flange");
  ASSERT_TRUE(puma);
  EXPECT_EQ(puma->joints[4], "q5");
  EXPECT_EQ(puma->low[1], -0.785398);
  EXPECT_EQ(puma->high[1], 3.926991);
  EXPECT_EQ(puma->speed[0], 1.92);
  EXPECT_EQ(puma->effort[5], 21.3);
}

TEST_F(UrdfChainTest, MujocoSeesTheSameRobotInTheFile) {
  const Result<UrdfChain> puma = read_urdf(shipped_urdf("puma560.urdf"), "link6");
  SimulatedArm arm;
  const Result<void> loaded = arm.load(shipped_urdf("puma560.urdf").c_str(), "link6");
  ASSERT_TRUE(loaded) << loaded.error().message.view();
  ASSERT_EQ(arm.joints(), 6u);
  const std::vector<double> q{0.3, 0.5, -1.2, 0.7, -0.6, 1.1};
  const Frame here = tool_frame(puma->chain, q), there = tool_frame(arm.arm().chain, q);
  for (std::size_t i = 0; i < 3; ++i) {
    EXPECT_NEAR(here.origin[i], there.origin[i], 1e-6);
    EXPECT_NEAR(here.x[i], there.x[i], 1e-6);
    EXPECT_NEAR(here.z[i], there.z[i], 1e-6);
    EXPECT_NEAR(arm.arm().high[i], puma->high[i], 1e-9);
  }
}

TEST_F(UrdfChainTest, RefusesAModelWithoutAChainOfTurningJoints) {
  const std::string ends = "<parent link='a'/><child link='b'/>";
  EXPECT_EQ(refusal("<joint name='j' type='fixed'>" + ends + "</joint>"),
            ": no joint turns between the root and the tip");
  EXPECT_EQ(refusal("<joint name='j' type='prismatic'>" + ends +
                        "<limit lower='0' upper='1' effort='1' velocity='1'/></joint>",
                    "b"),
            ": joint 'j' slides or floats; expected joints that turn");
  EXPECT_EQ(refusal("<joint name='j' type='continuous'>" + ends + "</joint>", "hand"), ": there is no link 'hand'");
  EXPECT_EQ(refusal("<joint name='j' type='revolute'>" + ends + "</joint>"),
            ": joint 'j' has no <limit>: give lower, upper, effort and velocity, or make it continuous or fixed");
  const std::string turns = "' type='revolute'><limit lower='1' upper='-1' effort='1' velocity='1'/>";
  EXPECT_EQ(refusal("<joint name='j" + turns + ends + "</joint>"),
            ": the lower limit of joint 'j' is above its upper one");
  EXPECT_EQ(refusal("<link name='c'/><joint name='j' type='fixed'><parent link='c'/><child link='b'/></joint>"
                    "<joint name='k' type='fixed'><parent link='b'/><child link='c'/></joint>"),
            ": its joints go round in a circle");
  EXPECT_EQ(read_urdf("/dev/zero", "").error().message.view(), "/dev/zero: is no ordinary file but a device");
  std::ofstream(path) << std::string((std::size_t{4} << 20) + 1, ' ');
  EXPECT_EQ(read_urdf(path, "").error().message.view(), path + ": is longer than 4 MiB");
  std::ofstream(path) << "<robot";
  EXPECT_FALSE(read_urdf(path, ""));
  EXPECT_EQ(read_urdf("no_such.urdf", "").error().message.view(), "no_such.urdf: cannot be read");
}

TEST_F(UrdfChainTest, TheComponentPublishesTheConstants) {
  Rig rig("urdf_model");
  rig.resource("model", shipped_urdf("puma560.urdf").c_str());
  const RigAnswer made = rig.init();
  ASSERT_TRUE(made) << made.text;
  EXPECT_EQ(rig.get<std::int32_t>("ndof"), 6);
  EXPECT_EQ(rig.get<double>("tau_max", 1), 186.4);
  EXPECT_NEAR(rig.get<DhLink>("dh", 1).a, .4318, 1e-12);
  EXPECT_TRUE(rig.cycle());
  rig.resource("model", "no_such.urdf");
  EXPECT_EQ(rig.reinit().text, "no_such.urdf: cannot be read");
}

}  // namespace
}  // namespace chimera::library
