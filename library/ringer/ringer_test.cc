// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include "chimera/task/rig.h"

namespace chimera {
namespace {

TEST(Ringer, RingsABurstOncePerEveryCycles) {
  Rig rig("ringer");
  rig.set("target", Text<64>("valve"));
  rig.set("every", std::int64_t{3});
  rig.set("burst", std::int32_t{2});
  ASSERT_TRUE(rig.init());
  ASSERT_TRUE(rig.on());
  for (int i = 1; i <= 7; ++i) {
    ASSERT_TRUE(rig.cycle());
    EXPECT_EQ(rig.signals().size(), static_cast<std::size_t>(i / 3 * 2));
    EXPECT_EQ(rig.get<std::int64_t>("rung"), i / 3 * 2);
  }
  EXPECT_EQ(rig.signals()[0], "wakeup valve");
}

TEST(Ringer, RefusesImpossibleConstants) {
  Rig rig("ringer");
  EXPECT_EQ(rig.init().text, "target is empty");
  rig.set("target", Text<64>("valve"));
  rig.set("every", std::int64_t{0});
  EXPECT_EQ(rig.init().text, "every is at least 1");
  rig.set("every", std::int64_t{1});
  rig.set("burst", std::int32_t{17});
  EXPECT_EQ(rig.init().text, "burst is 1 to 16");
}

}  // namespace
}  // namespace chimera
