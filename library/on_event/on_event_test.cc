// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <cmath>

#include "chimera/task/rig.h"

namespace chimera {
namespace {

TEST(OnEvent, SpendsItsTimeForEveryEventAndCounts) {
  Rig rig("on_event");
  rig.set("time", 0.002);
  ASSERT_TRUE(rig.init());
  ASSERT_TRUE(rig.on());
  for (int i = 1; i <= 3; ++i) {
    ASSERT_TRUE(rig.sync());
    ASSERT_TRUE(rig.cycle());
    EXPECT_EQ(rig.spent().count, i * 2'000'000);
    EXPECT_EQ(rig.get<std::int64_t>("answered"), i);
  }
}

TEST(OnEvent, RefusesAnInvalidTime) {
  Rig rig("on_event");
  for (double time : {-1e-3, 3601.0, std::nan("")}) {
    rig.set("time", time);
    EXPECT_EQ(rig.init().text, "time is 0 to 3600 s");
  }
}

}  // namespace
}  // namespace chimera
