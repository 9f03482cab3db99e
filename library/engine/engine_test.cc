// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "chimera/task/rig.h"

namespace chimera {
namespace {

struct EngineTest : testing::Test {
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

TEST_F(EngineTest, LetsGoWhileTheConfigurationIsIllegalAndWhenItIsSwitchedOff) {
  ASSERT_TRUE(rig.init());
  EXPECT_EQ(rig.get<double>("gas"), 0);  // before the first cycle
  EXPECT_GT(cycle(1000), 0);
  rig.illegal(true);
  EXPECT_EQ(cycle(1000), 0);
  EXPECT_EQ(cycle(std::nan("")), 0);
  rig.illegal(false);
  EXPECT_GT(cycle(1000), 0);
  ASSERT_TRUE(rig.off());
  EXPECT_EQ(rig.get<double>("gas"), 0);
}

TEST_F(EngineTest, AForceThatIsNotFiniteIsAFaultAndLeavesTheOutput) {
  ASSERT_TRUE(rig.init());
  const double before = cycle(1000);
  for (double wrong : {std::nan(""), std::numeric_limits<double>::infinity()}) {
    rig.set("fde", wrong);
    EXPECT_EQ(rig.cycle().text, "fde is not finite");
    EXPECT_EQ(rig.get<double>("gas"), before);
  }
}

TEST_F(EngineTest, RefusesALimitOutsideItsRange) {
  for (double wrong : {0.5, 100001.0, std::nan("")}) {
    rig.set("full_gas", wrong);
    EXPECT_EQ(rig.init().text, "full_gas is 1 to 100000 N") << wrong;
    EXPECT_EQ(rig.reinit().text, "full_gas is 1 to 100000 N") << wrong;
  }
}

}  // namespace
}  // namespace chimera
