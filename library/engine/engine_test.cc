// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include "chimera/task/rig.h"

namespace chimera {
namespace {

struct EngineTest : ::testing::Test {
  double cycle(double force) {
    rig.set("fde", force);
    EXPECT_TRUE(rig.cycle());
    return rig.get<double>("gas");
  }
  Rig rig{"engine"};
};

TEST_F(EngineTest, GivesGasInProportionAndNeverOutsideItsRange) {
  ASSERT_TRUE(rig.init());
  EXPECT_DOUBLE_EQ(cycle(1140), 0.5);
  EXPECT_EQ(cycle(1e300), 1);
  EXPECT_EQ(cycle(-1), 0);
}

TEST_F(EngineTest, ReinitTakesAnotherLimit) {
  ASSERT_TRUE(rig.init());
  rig.set("full_gas", 4000.0);
  ASSERT_TRUE(rig.reinit());
  EXPECT_DOUBLE_EQ(cycle(1000), 0.25);
}

TEST_F(EngineTest, StartsAtAFreshCommandOnly) {
  ASSERT_TRUE(rig.init());
  rig.set("gas", 0.5);
  rig.inherit("gas", milliseconds(20), milliseconds(20));
  ASSERT_TRUE(rig.on());
  EXPECT_EQ(rig.get<double>("gas"), 0.5);
  ASSERT_TRUE(rig.off());
  rig.set("gas", 0.5);
  rig.inherit("gas", milliseconds(500), milliseconds(20));
  ASSERT_TRUE(rig.on());
  EXPECT_EQ(rig.get<double>("gas"), 0);
}

}  // namespace
}  // namespace chimera
