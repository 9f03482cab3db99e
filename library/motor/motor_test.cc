// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include "chimera/task/rig.h"

namespace chimera {
namespace {

struct MotorTest : ::testing::Test {
  double cycle(double force) {
    rig.set("fd", force);
    EXPECT_TRUE(rig.cycle());
    return rig.get<double>("fm");
  }
  Rig rig{"motor"};
};

TEST_F(MotorTest, DrivesAndBrakesUpToItsLimit) {
  ASSERT_TRUE(rig.init());
  EXPECT_EQ(cycle(3000), 3000);
  EXPECT_EQ(cycle(-3000), -3000);
  EXPECT_EQ(cycle(1e300), 5000);
  EXPECT_EQ(cycle(-1e300), -5000);
}

TEST_F(MotorTest, ReinitTakesAnotherLimit) {
  ASSERT_TRUE(rig.init());
  rig.set("force_max", 2000.0);
  ASSERT_TRUE(rig.reinit());
  EXPECT_EQ(cycle(-3000), -2000);
}

TEST_F(MotorTest, StartsAtAFreshCommandOnly) {
  ASSERT_TRUE(rig.init());
  rig.set("fm", 3000.0);
  rig.inherit("fm", milliseconds(20), milliseconds(20));
  ASSERT_TRUE(rig.on());
  EXPECT_EQ(rig.get<double>("fm"), 3000.0);
  ASSERT_TRUE(rig.off());
  rig.set("fm", 3000.0);
  rig.inherit("fm", milliseconds(500), milliseconds(20));
  ASSERT_TRUE(rig.on());
  EXPECT_EQ(rig.get<double>("fm"), 0);
}

}  // namespace
}  // namespace chimera
