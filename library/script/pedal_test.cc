// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <string>

#include "chimera/task/rig.h"

namespace chimera {
namespace {

struct NamedPedal {
  const char* component;
  const char* output;
  double full;  // N
};

struct PedalTest : ::testing::TestWithParam<NamedPedal> {};

TEST_P(PedalTest, FollowsItsScriptAndLetsGoWhenOff) {
  Rig rig(GetParam().component);
  rig.resource("pedal", "0:0 1:0.5 2:0.5 3:0");
  ASSERT_TRUE(rig.init());
  ASSERT_TRUE(rig.on());
  EXPECT_EQ(rig.get<double>(GetParam().output), 0);
  ASSERT_TRUE(rig.cycle(milliseconds(500)));
  EXPECT_DOUBLE_EQ(rig.get<double>(GetParam().output), 0.25 * GetParam().full);
  ASSERT_TRUE(rig.cycle(milliseconds(1000)));
  EXPECT_DOUBLE_EQ(rig.get<double>(GetParam().output), 0.5 * GetParam().full);
  ASSERT_TRUE(rig.off());
  EXPECT_EQ(rig.get<double>(GetParam().output), 0);
  ASSERT_TRUE(rig.on());  // restarts the script
  EXPECT_EQ(rig.get<double>(GetParam().output), 0);
}

TEST_P(PedalTest, AsksForTheForceOfItsConstant) {
  Rig rig(GetParam().component);
  rig.resource("pedal", "0:1");
  rig.set("full_force", 100.0);
  ASSERT_TRUE(rig.init());
  ASSERT_TRUE(rig.on());
  EXPECT_DOUBLE_EQ(rig.get<double>(GetParam().output), 100);
}

TEST_P(PedalTest, RefusesForcesThatNoPedalHas) {
  const auto said = [](const char* script, double force) {
    Rig rig(GetParam().component);
    rig.resource("pedal", script);
    rig.set("full_force", force);
    return rig.init().text;
  };
  EXPECT_EQ(said("0:0 1:1.5", 100), "the travel of a pedal is 0 to 1");
  EXPECT_EQ(said("0:-0.1", 100), "the travel of a pedal is 0 to 1");
  EXPECT_EQ(said("", 100), "the script is empty: write at:value at:value ...");
  EXPECT_EQ(said("0:0", 20001), "full_force is 0 to 20000 N");
  EXPECT_EQ(said("0:0", 20000), "");
}

INSTANTIATE_TEST_SUITE_P(Of, PedalTest,
                         ::testing::Values(NamedPedal{"accel", "fra", 2280}, NamedPedal{"brake", "frb", 12000}),
                         [](const auto& one) { return std::string(one.param.component); });

}  // namespace
}  // namespace chimera
