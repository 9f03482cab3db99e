// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "chimera/task/rig.h"

namespace chimera {
namespace {

struct MotorTest : testing::Test {
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

TEST_F(MotorTest, LetsGoWhileTheConfigurationIsIllegalAndWhenItIsSwitchedOff) {
  ASSERT_TRUE(rig.init());
  EXPECT_EQ(rig.get<double>("fm"), 0);  // before the first cycle
  EXPECT_GT(cycle(1000), 0);
  rig.illegal(true);
  EXPECT_EQ(cycle(1000), 0);
  EXPECT_EQ(cycle(std::nan("")), 0);
  rig.illegal(false);
  EXPECT_GT(cycle(1000), 0);
  ASSERT_TRUE(rig.off());
  EXPECT_EQ(rig.get<double>("fm"), 0);
}

TEST_F(MotorTest, AForceThatIsNotFiniteIsAFaultAndLeavesTheOutput) {
  ASSERT_TRUE(rig.init());
  const double before = cycle(1000);
  for (double wrong : {std::nan(""), std::numeric_limits<double>::infinity()}) {
    rig.set("fd", wrong);
    EXPECT_EQ(rig.cycle().text, "fd is not finite");
    EXPECT_EQ(rig.get<double>("fm"), before);
  }
}

TEST_F(MotorTest, RefusesALimitOutsideItsRange) {
  for (double wrong : {-1.0, 50001.0, std::nan("")}) {
    rig.set("force_max", wrong);
    EXPECT_EQ(rig.init().text, "force_max is 0 to 50000 N") << wrong;
    EXPECT_EQ(rig.reinit().text, "force_max is 0 to 50000 N") << wrong;
  }
}

}  // namespace
}  // namespace chimera
