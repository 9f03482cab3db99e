// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include "chimera/task/rig.h"

using namespace chimera;

TEST(@TYPE@Control, AnswersAnErrorAndAddsItUp) {
  Rig rig("@NAME@_control");
  rig.set("kp", 2.0);
  rig.set("ki", 10.0);
  ASSERT_TRUE(rig.on());
  rig.set("wanted", 3.0);
  rig.set("speed", 1.0);
  ASSERT_TRUE(rig.cycle(milliseconds(100)));
  EXPECT_NEAR(rig.get<double>("u"), 2 * 2.0 + 10 * 2.0 * 0.1, 1e-12);
}

TEST(@TYPE@Control, PutsOutNoMoreThanThereIs) {
  Rig rig("@NAME@_control");
  rig.set("kp", 1000.0);
  ASSERT_TRUE(rig.on());
  rig.set("wanted", 3.0);
  rig.set("speed", 0.0);
  ASSERT_TRUE(rig.cycle(milliseconds(1)));
  EXPECT_EQ(rig.get<double>("u"), 24.0);
}
