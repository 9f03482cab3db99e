// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include "chimera/task/rig.h"

namespace chimera {
namespace {

TEST(Accel, FollowsItsScriptAndLetsGoWhenOff) {
  Rig rig("accel");
  rig.resource("pedal", "0:0 1:0.5 2:0.5 3:0");
  ASSERT_TRUE(rig.init());
  ASSERT_TRUE(rig.on());
  EXPECT_EQ(rig.get<double>("fra"), 0);
  ASSERT_TRUE(rig.cycle(milliseconds(500)));
  EXPECT_DOUBLE_EQ(rig.get<double>("fra"), 0.25 * 2280);
  ASSERT_TRUE(rig.cycle(milliseconds(1000)));
  EXPECT_DOUBLE_EQ(rig.get<double>("fra"), 0.5 * 2280);
  ASSERT_TRUE(rig.off());
  EXPECT_EQ(rig.get<double>("fra"), 0);
  ASSERT_TRUE(rig.on());  // the script begins anew
  EXPECT_EQ(rig.get<double>("fra"), 0);
}

TEST(Accel, AsksForTheForceOfItsConstant) {
  Rig rig("accel");
  rig.resource("pedal", "0:1");
  rig.set("full_force", 100.0);
  ASSERT_TRUE(rig.init());
  ASSERT_TRUE(rig.on());
  EXPECT_DOUBLE_EQ(rig.get<double>("fra"), 100);
}

TEST(Accel, RefusesWhatNoPedalDoes) {
  const auto said = [](const char* script, double force) {
    Rig rig("accel");
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

}  // namespace
}  // namespace chimera
