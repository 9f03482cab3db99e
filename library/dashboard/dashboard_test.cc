// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <cmath>

#include "chimera/task/rig.h"

namespace chimera {
namespace {

TEST(Dashboard, ShowsWholeKilometresAnHourAndTenthsOfAKilometre) {
  Rig rig("dashboard");
  rig.set("vz", 27.7);
  rig.set("xz", 1299.0);
  ASSERT_TRUE(rig.on());
  EXPECT_EQ(rig.get<double>("speedometer"), 100);
  EXPECT_DOUBLE_EQ(rig.get<double>("odometer"), 1.2);  // rounded down
}

TEST(Dashboard, HasNoSignOnItsSpeedometer) {
  Rig rig("dashboard");
  rig.set("vz", -10.0);
  rig.set("xz", 0.0);
  ASSERT_TRUE(rig.cycle());
  EXPECT_EQ(rig.get<double>("speedometer"), 36);
}

TEST(Dashboard, PassesNaNOnAndIsOverItWithTheNextInput) {
  Rig rig("dashboard");
  rig.set("vz", std::nan(""));
  rig.set("xz", HUGE_VAL);
  ASSERT_TRUE(rig.cycle());
  EXPECT_TRUE(std::isnan(rig.get<double>("speedometer")));
  EXPECT_EQ(rig.get<double>("odometer"), HUGE_VAL);
  rig.set("vz", 10.0);
  rig.set("xz", 500.0);
  ASSERT_TRUE(rig.cycle());
  EXPECT_EQ(rig.get<double>("speedometer"), 36);
  EXPECT_EQ(rig.get<double>("odometer"), 0.5);
}

}  // namespace
}  // namespace chimera
