// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "chimera/task/rig.h"

namespace chimera {
namespace {

struct WheelsTest : testing::Test {
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

TEST_F(WheelsTest, LetsGoWhileTheConfigurationIsIllegalAndWhenItIsSwitchedOff) {
  ASSERT_TRUE(rig.init());
  EXPECT_EQ(rig.get<double>("fb"), 0);  // before the first cycle
  EXPECT_GT(cycle(1000), 0);
  rig.illegal(true);
  EXPECT_EQ(cycle(1000), 0);
  EXPECT_EQ(cycle(std::nan("")), 0);
  rig.illegal(false);
  EXPECT_GT(cycle(1000), 0);
  ASSERT_TRUE(rig.off());
  EXPECT_EQ(rig.get<double>("fb"), 0);
}

TEST_F(WheelsTest, AForceThatIsNotFiniteIsAFaultAndLeavesTheOutput) {
  ASSERT_TRUE(rig.init());
  const double before = cycle(1000);
  for (double wrong : {std::nan(""), std::numeric_limits<double>::infinity()}) {
    rig.set("fdw", wrong);
    EXPECT_EQ(rig.cycle().text, "fdw is not finite");
    EXPECT_EQ(rig.get<double>("fb"), before);
  }
}

TEST_F(WheelsTest, RefusesALimitOutsideItsRange) {
  for (double wrong : {-1.0, 20001.0, std::nan("")}) {
    rig.set("brake_limit", wrong);
    EXPECT_EQ(rig.init().text, "brake_limit is 0 to 20000 N") << wrong;
    EXPECT_EQ(rig.reinit().text, "brake_limit is 0 to 20000 N") << wrong;
  }
}

}  // namespace
}  // namespace chimera
