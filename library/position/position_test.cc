// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>

#include "chimera/task/rig.h"

namespace chimera {
namespace {

TEST(Position, IsTheWayInWholeCounts) {
  Rig rig("position");
  rig.set("counts", std::int32_t{4});
  rig.set("wheel_radius", 0.5);
  ASSERT_TRUE(rig.init());
  rig.set("xw", 0.6 * std::numbers::pi);  // more than a quarter turn
  ASSERT_TRUE(rig.on());
  EXPECT_DOUBLE_EQ(rig.get<double>("xz"), 0.5 * std::numbers::pi * 0.5);
  rig.set("xw", -0.1);  // backwards: the next lower count
  ASSERT_TRUE(rig.cycle());
  EXPECT_DOUBLE_EQ(rig.get<double>("xz"), -0.5 * std::numbers::pi * 0.5);
}

TEST(Position, ByDefaultErrsByLessThanATenthOfAMillimetre) {
  Rig rig("position");
  ASSERT_TRUE(rig.init());
  rig.set("xw", 1234.5678);
  ASSERT_TRUE(rig.on());
  EXPECT_NEAR(rig.get<double>("xz"), 1234.5678 * 0.3, 1e-4);
}

TEST(Position, PassesOnThatItDoesNotKnow) {
  Rig rig("position");
  ASSERT_TRUE(rig.init());
  rig.set("xw", std::numeric_limits<double>::quiet_NaN());
  ASSERT_TRUE(rig.cycle());
  EXPECT_TRUE(std::isnan(rig.get<double>("xz")));
}

TEST(Position, RefusesAResolverWithoutCounts) {
  Rig rig("position");
  rig.set("counts", std::int32_t{0});
  EXPECT_EQ(rig.init().text, "counts and wheel_radius must be above 0");
}

}  // namespace
}  // namespace chimera
