// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <cmath>

#include "chimera/task/rig.h"

namespace chimera {
namespace {

TEST(TimeDerivative, IsTheBackwardDifference) {
  Rig rig("tderiv");
  rig.set("x", 1.0);
  ASSERT_TRUE(rig.init());
  ASSERT_TRUE(rig.on());
  rig.set("x", 1.5);
  ASSERT_TRUE(rig.cycle(milliseconds(100)));
  EXPECT_DOUBLE_EQ(rig.get<double>("dx"), 5.0);
  rig.set("x", 1.25);
  ASSERT_TRUE(rig.cycle(milliseconds(50)));
  EXPECT_DOUBLE_EQ(rig.get<double>("dx"), -5.0);
}

TEST(TimeDerivative, DividesByTheTimeThatWentByWhenReleasesWereDropped) {
  Rig rig("tderiv");
  rig.set("x", 0.0);
  ASSERT_TRUE(rig.on());
  rig.set("x", 3.0);
  ASSERT_TRUE(rig.cycle(milliseconds(3)));  // two of three releases dropped
  EXPECT_DOUBLE_EQ(rig.get<double>("dx"), 1000.0);
}

TEST(TimeDerivative, StartsAtZeroForAnySignal) {
  Rig rig("tderiv");
  EXPECT_EQ(rig.get<double>("dx"), 0.0);
  rig.set("x", 42.0);
  ASSERT_TRUE(rig.on());
  EXPECT_EQ(rig.get<double>("dx"), 0.0);
  ASSERT_TRUE(rig.cycle());
  EXPECT_EQ(rig.get<double>("dx"), 0.0);
}

TEST(TimeDerivative, IsOverNaNTwoGoodInputsLater) {
  Rig rig("tderiv");
  rig.set("x", 1.0);
  ASSERT_TRUE(rig.on());
  rig.set("x", std::nan(""));
  ASSERT_TRUE(rig.cycle());
  EXPECT_TRUE(std::isnan(rig.get<double>("dx")));
  rig.set("x", 1.0);
  ASSERT_TRUE(rig.cycle());
  EXPECT_TRUE(std::isnan(rig.get<double>("dx")));
  rig.set("x", 1.5);
  ASSERT_TRUE(rig.cycle());
  EXPECT_DOUBLE_EQ(rig.get<double>("dx"), 500.0);
}

}  // namespace
}  // namespace chimera
