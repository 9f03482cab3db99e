// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include "library/signals/testing/signal_rig.h"

namespace chimera {
namespace {

TEST(Deadband, IsTheCentreWithinAndMovedByTheWidthOutside) {
  SignalRig rig("deadband");
  rig.set("width", 0.25);
  rig.set("center", 1.0);
  ASSERT_TRUE(rig.init());
  for (double x : {0.75, 0.9, 1.0, 1.25}) EXPECT_EQ(rig.step(x), 1) << x;
  EXPECT_DOUBLE_EQ(rig.step(1.5), 1.25);
  EXPECT_DOUBLE_EQ(rig.step(0.5), 0.75);
  EXPECT_DOUBLE_EQ(rig.step(-3), -2.75);
}

TEST(Deadband, HasNoJumpAnywhere) {
  SignalRig rig("deadband");
  rig.set("width", 0.3);
  ASSERT_TRUE(rig.init());
  double last = rig.step(-1);
  for (double x = -1; x < 1; x += 1e-3) {
    const double y = rig.step(x);
    ASSERT_LE(std::abs(y - last), 1e-3 + 1e-12) << x;
    last = y;
  }
}

TEST(Deadband, ZeroWidthChangesNothing) {
  SignalRig rig("deadband");
  rig.set("width", 0.0);
  ASSERT_TRUE(rig.init());
  for (double x : {-1.5, 0.0, 1e9}) EXPECT_EQ(rig.step(x), x);
}

TEST(Deadband, RefusesAWidthBelowNothingAndNaN) {
  SignalRig rig("deadband");
  rig.set("width", -0.1);
  EXPECT_EQ(rig.init().text, "width must be 0 or more, and center finite");
  rig.set("width", 0.1);
  rig.set("center", std::nan(""));
  EXPECT_EQ(rig.init().text, "width must be 0 or more, and center finite");
  rig.set("center", 0.0);
  ASSERT_TRUE(rig.init());
  rig.set("x", std::nan(""));
  EXPECT_EQ(rig.cycle().text, "x is not a finite number");
  EXPECT_TRUE(rig.error());
}

}  // namespace
}  // namespace chimera
