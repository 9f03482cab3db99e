// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <cmath>

#include "chimera/task/rig.h"

namespace chimera {
namespace {

TEST(Gain, MultipliesByItsConstant) {
  Rig rig("gain");
  rig.set("k", -2.5);
  rig.set("x", 4.0);
  ASSERT_TRUE(rig.init());
  ASSERT_TRUE(rig.on());
  EXPECT_DOUBLE_EQ(rig.get<double>("y"), -10.0);  // computed by on: no step in the first cycle
  rig.set("x", 2.0);
  ASSERT_TRUE(rig.cycle());
  EXPECT_DOUBLE_EQ(rig.get<double>("y"), -5.0);
}

TEST(Gain, PassesTheSignalOnWithoutAConstant) {
  Rig rig("gain");
  rig.set("x", 4.0);
  ASSERT_TRUE(rig.cycle());
  EXPECT_DOUBLE_EQ(rig.get<double>("y"), 4.0);
}

TEST(Gain, PassesNaNOnAndIsOverItWithTheNextInput) {
  Rig rig("gain");
  rig.set("x", std::nan(""));
  ASSERT_TRUE(rig.cycle());
  EXPECT_TRUE(std::isnan(rig.get<double>("y")));
  rig.set("x", 4.0);
  ASSERT_TRUE(rig.cycle());
  EXPECT_EQ(rig.get<double>("y"), 4.0);
}

}  // namespace
}  // namespace chimera
