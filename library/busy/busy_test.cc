// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <cmath>

#include "chimera/task/rig.h"

namespace chimera {
namespace {

TEST(Busy, SpendsItsTimeInEveryCycle) {
  Rig rig("busy");
  rig.set("time", 0.0025);
  ASSERT_TRUE(rig.init());
  ASSERT_TRUE(rig.on());
  EXPECT_EQ(rig.spent().count, 0);
  ASSERT_TRUE(rig.cycle());
  EXPECT_EQ(rig.spent().count, 2'500'000);
  ASSERT_TRUE(rig.cycle());
  EXPECT_EQ(rig.spent().count, 5'000'000);
}

TEST(Busy, RoundsToTheNearestNanosecond) {
  Rig rig("busy");
  rig.set("time", 1.6e-9);
  ASSERT_TRUE(rig.cycle());
  EXPECT_EQ(rig.spent().count, 2);
}

TEST(Busy, RefusesAnInvalidTime) {
  Rig rig("busy");
  for (double time : {-1e-3, 3601.0, std::nan("")}) {
    rig.set("time", time);
    EXPECT_EQ(rig.init().text, "time is 0 to 3600 s");
  }
}

}  // namespace
}  // namespace chimera
