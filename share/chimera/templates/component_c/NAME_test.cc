// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include "chimera/task/rig.h"

using namespace chimera;

TEST(@TYPE@, GoesHalfTheWayWhenTheStepIsTheTimeConstant) {
  Rig rig("@NAME@");
  rig.set("time", 0.1);
  rig.set("x", 0.0);
  ASSERT_TRUE(rig.init());
  ASSERT_TRUE(rig.on());
  rig.set("x", 1.0);
  ASSERT_TRUE(rig.cycle(milliseconds(100)));
  EXPECT_DOUBLE_EQ(rig.get<double>("y"), 0.5);
}

TEST(@TYPE@, StartsWithoutAStep) {
  Rig rig("@NAME@");
  rig.set("x", 42.0);
  ASSERT_TRUE(rig.on());
  EXPECT_DOUBLE_EQ(rig.get<double>("y"), 42.0);
}
