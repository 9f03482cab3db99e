// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include "chimera/task/rig.h"

namespace chimera {
namespace {

TEST(Ccui, HoldsEachSetSpeedUntilTheNextButton) {
  Rig rig("ccui");
  rig.resource("buttons", "0:0 1:90 2:108");
  ASSERT_TRUE(rig.init());
  ASSERT_TRUE(rig.on());
  EXPECT_EQ(rig.get<double>("vr"), 0);  // not switched on yet
  ASSERT_TRUE(rig.cycle(milliseconds(1500)));
  EXPECT_DOUBLE_EQ(rig.get<double>("vr"), 25);  // no ramp between two buttons
  ASSERT_TRUE(rig.cycle(milliseconds(1000)));
  EXPECT_DOUBLE_EQ(rig.get<double>("vr"), 30);
  ASSERT_TRUE(rig.off());
  EXPECT_EQ(rig.get<double>("vr"), 0);
}

TEST(Ccui, RefusesSpeedsThatNoCarIsSetTo) {
  const auto said = [](const char* script) {
    Rig rig("ccui");
    rig.resource("buttons", script);
    return rig.init().text;
  };
  EXPECT_EQ(said("0:251"), "a set speed is 0 to 250 km/h");
  EXPECT_EQ(said("0:-1"), "a set speed is 0 to 250 km/h");
  EXPECT_EQ(said("0"), "a point of the script has no ':' after its first number");
  EXPECT_EQ(said("0:250"), "");
}

}  // namespace
}  // namespace chimera
