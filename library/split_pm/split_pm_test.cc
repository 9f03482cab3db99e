// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "chimera/task/rig.h"

namespace chimera {
namespace {

TEST(SplitPm, SendsADrivingForceToTheEngineAndABrakingForceToTheBrakes) {
  Rig rig("split_pm");
  for (double fd : {1500.0, 0.0, -700.0}) {
    rig.set("fd", fd);
    ASSERT_TRUE(rig.cycle());
    EXPECT_EQ(rig.get<double>("fde"), fd > 0 ? fd : 0);
    EXPECT_EQ(rig.get<double>("fdw"), fd < 0 ? -fd : 0);
    EXPECT_FALSE(std::signbit(rig.get<double>("fdw")));
  }
}

TEST(SplitPm, SplitsFromOnAlready) {
  Rig rig("split_pm");
  rig.set("fd", -700.0);
  ASSERT_TRUE(rig.on());
  EXPECT_EQ(rig.get<double>("fde"), 0);
  EXPECT_EQ(rig.get<double>("fdw"), 700);
}

TEST(SplitPm, AForceThatIsNotFiniteIsAFaultAndLeavesTheOutputs) {
  Rig rig("split_pm");
  rig.set("fd", 1500.0);
  ASSERT_TRUE(rig.cycle());
  for (double wrong : {std::nan(""), -std::numeric_limits<double>::infinity()}) {
    rig.set("fd", wrong);
    EXPECT_EQ(rig.cycle().text, "fd is not finite");
    EXPECT_EQ(rig.on().text, "fd is not finite");
  }
  EXPECT_EQ(rig.get<double>("fde"), 1500);
  EXPECT_EQ(rig.get<double>("fdw"), 0);
}

}  // namespace
}  // namespace chimera
