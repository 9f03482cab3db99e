// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include "chimera/task/rig.h"

using namespace chimera;

TEST(@TYPE@Wave, IsAtItsPeakAfterAQuarterOfAPeriod) {
  Rig rig("@NAME@_wave");
  rig.set("amplitude", 2.0);
  rig.set("frequency", 1.0);
  ASSERT_TRUE(rig.on());
  for (int i = 0; i < 25; ++i) ASSERT_TRUE(rig.cycle(milliseconds(10)));
  EXPECT_NEAR(rig.get<double>("wave"), 2.0, 1e-9);
}
