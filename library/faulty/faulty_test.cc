// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <cmath>

#include "chimera/task/rig.h"

namespace chimera {
namespace {

TEST(Faulty, CountsUntilItThrows) {
  Rig rig("faulty");
  rig.set("throw_after", 0.003);
  ASSERT_TRUE(rig.init());
  ASSERT_TRUE(rig.on());
  ASSERT_TRUE(rig.cycle());
  ASSERT_TRUE(rig.cycle());
  EXPECT_EQ(rig.get<double>("y"), 2);
  EXPECT_EQ(rig.cycle().text, "thrown on purpose");
}

TEST(Faulty, PutsNanOnItsSafetyPort) {
  Rig rig("faulty");
  rig.set("nan_after", 0.002);
  ASSERT_TRUE(rig.on());
  ASSERT_TRUE(rig.cycle());
  EXPECT_EQ(rig.get<double>("y"), 1);
  ASSERT_TRUE(rig.cycle());
  EXPECT_TRUE(std::isnan(rig.get<double>("y")));
}

TEST(Faulty, CountsFromOnAgain) {
  Rig rig("faulty");
  rig.set("throw_after", 0.002);
  ASSERT_TRUE(rig.on());
  ASSERT_TRUE(rig.cycle());
  ASSERT_FALSE(rig.cycle());
  ASSERT_TRUE(rig.clear());
  ASSERT_TRUE(rig.on());
  ASSERT_TRUE(rig.cycle());
  EXPECT_EQ(rig.get<double>("y"), 1);
}

}  // namespace
}  // namespace chimera
