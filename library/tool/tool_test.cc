// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <limits>

#include "chimera/task/geometry.h"
#include "chimera/task/rig.h"

namespace chimera {
namespace {

struct ToolTest : ::testing::Test {
  Rig rig{"tool"};
  Pose frame{{0.1, 0, 0.2}, {0.8, 0.6, 0, 0}};
  void SetUp() override {
    rig.set("pose", frame);
    rig.set("mass", 1.5);
  }
};

TEST_F(ToolTest, PublishesFrameAndMassAtInitAndItsPoseWhileOn) {
  ASSERT_TRUE(rig.init());
  EXPECT_EQ(rig.get<Pose>("tool").position[2], 0.2);
  EXPECT_EQ(rig.get<Pose>("tool").orientation[1], 0.6);
  EXPECT_EQ(rig.get<double>("payload_mass"), 1.5);
  EXPECT_FALSE(rig.get<bool>("is_attached"));
  ASSERT_TRUE(rig.on());
  ASSERT_TRUE(rig.cycle());
  EXPECT_TRUE(rig.get<bool>("is_attached"));
  ASSERT_TRUE(rig.off());
  EXPECT_FALSE(rig.get<bool>("is_attached"));
}

TEST_F(ToolTest, PublishesAnotherMassByReinit) {
  ASSERT_TRUE(rig.init());
  rig.set("mass", 2.5);
  ASSERT_TRUE(rig.reinit());
  EXPECT_EQ(rig.get<double>("payload_mass"), 2.5);
}

TEST_F(ToolTest, RefusesAnInvalidFrameOrMass) {
  rig.set("mass", std::numeric_limits<double>::quiet_NaN());
  EXPECT_EQ(rig.init().text, "mass is 0 to 100 kg");
  rig.set("mass", 1.0);
  frame.orientation[0] = 0;
  rig.set("pose", frame);
  EXPECT_EQ(rig.init().text, "pose: not finite, or the orientation is no unit quaternion");
}

}  // namespace
}  // namespace chimera
