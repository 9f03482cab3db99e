// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include "chimera/task/geometry.h"
#include "chimera/task/rig.h"

namespace chimera {
namespace {

TEST(Ctraj, GoesRoundItsFigureFromTheTimeItGoesOn) {
  Rig rig("ctraj");
  rig.set("centre", Pose{{0.5, 0, 0.3}, {1, 0, 0, 0}});
  rig.set("amplitude", 0.1, 0);
  rig.set("frequency", 0.25, 0);
  ASSERT_TRUE(rig.init());
  ASSERT_TRUE(rig.on());
  EXPECT_EQ(rig.get<Pose>("xd").position[0], 0.5);
  for (int i = 0; i < 100; ++i) ASSERT_TRUE(rig.cycle(milliseconds(10)));
  EXPECT_NEAR(rig.get<Pose>("xd").position[0], 0.6, 1e-12);
  EXPECT_EQ(rig.get<Pose>("xd").position[2], 0.3);
}

TEST(Ctraj, RefusesACentreWithoutOrientation) {
  Rig rig("ctraj");
  rig.set("centre", Pose{{0.5, 0, 0.3}, {0, 0, 0, 0}});
  EXPECT_EQ(rig.init().text, "centre: the orientation is no unit quaternion");
}

}  // namespace
}  // namespace chimera
