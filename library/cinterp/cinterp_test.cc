// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <cmath>

#include "chimera/task/geometry.h"
#include "chimera/task/rig.h"

namespace chimera {
namespace {

constexpr Pose kHere{{0, 0, 0}, {1, 0, 0, 0}};
constexpr Pose kThere{{0.3, 0.4, 0}, {0, 0, 0, 1}};

struct CinterpTest : testing::Test {
  Rig rig{"cinterp"};
  void start(double leash) {
    rig.set("leash", leash);
    rig.set("xm", kHere);
    rig.set("xd", kThere);
    ASSERT_TRUE(rig.init());
    ASSERT_TRUE(rig.on());
  }
};

TEST_F(CinterpTest, BeginsWhereTheToolIsAndGoesStraightNoFasterThanAllowed) {
  start(10);
  Pose before = rig.get<Pose>("xr");
  EXPECT_EQ(before.position[0], 0);
  for (int i = 0; i < 500; ++i) {
    ASSERT_TRUE(rig.cycle());
    const Pose now = rig.get<Pose>("xr");
    const double step = std::hypot(now.position[0] - before.position[0], now.position[1] - before.position[1]);
    EXPECT_LE(step, 0.5e-3 + 1e-12);
    EXPECT_NEAR(now.position[0] * 4, now.position[1] * 3, 1e-12);
    before = now;
  }
}

TEST_F(CinterpTest, ArrivesInPlaceAndOrientation) {
  start(10);
  for (int i = 0; i < 6000; ++i) ASSERT_TRUE(rig.cycle());
  const Pose end = rig.get<Pose>("xr");
  EXPECT_NEAR(end.position[0], 0.3, 1e-6);
  EXPECT_NEAR(end.position[1], 0.4, 1e-6);
  EXPECT_NEAR(std::abs(end.orientation[3]), 1, 1e-6);
}

TEST_F(CinterpTest, StaysNearAToolThatDoesNotFollow) {
  start(0.05);
  for (int i = 0; i < 3000; ++i) ASSERT_TRUE(rig.cycle());
  const Pose end = rig.get<Pose>("xr");
  EXPECT_NEAR(std::hypot(end.position[0], end.position[1]), 0.05, 1e-9);
}

TEST_F(CinterpTest, StandsWhileTheConfigurationIsIllegalAndRefusesWhatIsNoPose) {
  start(10);
  rig.illegal(true);
  ASSERT_TRUE(rig.cycle());
  EXPECT_EQ(rig.get<Pose>("xr").position[0], 0);
  rig.illegal(false);
  rig.set("xd", Pose{{std::nan(""), 0, 0}, {1, 0, 0, 0}});
  EXPECT_EQ(rig.cycle().text, "a pose is not finite");
  rig.set("xm", Pose{{0, 0, 0}, {0, 0, 0, 0}});
  EXPECT_EQ(rig.on().text, "xm is not finite or no orientation: xr cannot begin there");
}

}  // namespace
}  // namespace chimera
