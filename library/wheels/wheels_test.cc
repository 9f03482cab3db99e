// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include "chimera/task/rig.h"

namespace chimera {
namespace {

struct WheelsTest : ::testing::Test {
  double cycle(double force) {
    rig.set("fdw", force);
    EXPECT_TRUE(rig.cycle());
    return rig.get<double>("fb");
  }
  Rig rig{"wheels"};
};

TEST_F(WheelsTest, PressesUpToTheLimitOfTheBrakes) {
  ASSERT_TRUE(rig.init());
  EXPECT_EQ(cycle(3000), 3000);
  EXPECT_EQ(cycle(1e300), 12000);
  EXPECT_EQ(cycle(-1), 0);
}

TEST_F(WheelsTest, ReinitTakesAnotherLimit) {
  ASSERT_TRUE(rig.init());
  rig.set("brake_limit", 2000.0);
  ASSERT_TRUE(rig.reinit());
  EXPECT_EQ(cycle(3000), 2000);
}

TEST_F(WheelsTest, StartsAtAFreshCommandOnly) {
  ASSERT_TRUE(rig.init());
  rig.set("fb", 4000.0);
  rig.inherit("fb", milliseconds(20), milliseconds(20));
  ASSERT_TRUE(rig.on());
  EXPECT_EQ(rig.get<double>("fb"), 4000.0);
  ASSERT_TRUE(rig.off());
  rig.set("fb", 4000.0);
  rig.inherit("fb", milliseconds(500), milliseconds(20));
  ASSERT_TRUE(rig.on());
  EXPECT_EQ(rig.get<double>("fb"), 0);
}

}  // namespace
}  // namespace chimera
