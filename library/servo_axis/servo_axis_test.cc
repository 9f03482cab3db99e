// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <cmath>

#include "chimera/task/rig.h"
#include "library/servo_axis/friction_axis.h"

namespace chimera {
namespace {

struct ServoAxisTest : ::testing::Test {
  Rig rig{"servo_axis"};

  void SetUp() override {
    rig.set("ndof", std::int32_t{2});
    for (std::size_t i = 0; i < 2; ++i) {
      rig.set("inertia", 0.5 + static_cast<double>(i), i);
      rig.set("viscous", 0.1, i);
      rig.set("coulomb", 0.2, i);
      rig.set("start_pose", 1.0 + static_cast<double>(i), i);
    }
    push(0, 0);
  }
  void push(double first, double second) { rig.set("tau", first, 0), rig.set("tau", second, 1); }
  double q(std::size_t i) { return rig.get<double>("q", i); }
  double qd(std::size_t i) { return rig.get<double>("qd", i); }
};

TEST_F(ServoAxisTest, MovesEachAxisByItsTorque) {
  ASSERT_TRUE(rig.init() && rig.on());
  EXPECT_EQ(q(0), 1);
  EXPECT_EQ(q(1), 2);
  library::FrictionAxis axis;
  axis.refit({0.5, 0.1, 0.2});
  axis.place(1, 0);
  push(3, 0.1);
  for (int i = 0; i < 100; ++i) {
    ASSERT_TRUE(rig.cycle(milliseconds(1)));
    axis.step(3, 1e-3);
  }
  EXPECT_EQ(q(0), axis.position());
  EXPECT_EQ(qd(0), axis.velocity());
  EXPECT_EQ(q(1), 2) << "held by its friction";
}

TEST_F(ServoAxisTest, StopsAtOffAndWhileTheConfigurationIsIllegal) {
  ASSERT_TRUE(rig.init() && rig.on());
  push(3, 3);
  ASSERT_TRUE(rig.cycle(milliseconds(10)));
  const double there = q(0);
  EXPECT_GT(qd(0), 0);
  rig.illegal(true);
  ASSERT_TRUE(rig.cycle(milliseconds(10)));
  EXPECT_EQ(q(0), there);
  EXPECT_EQ(qd(0), 0);
  rig.illegal(false);
  ASSERT_TRUE(rig.cycle(milliseconds(10)));
  EXPECT_GT(q(0), there);
  ASSERT_TRUE(rig.off());
  EXPECT_EQ(qd(0), 0);
}

TEST_F(ServoAxisTest, ChangesTheLoadOfAMovingAxis) {
  ASSERT_TRUE(rig.init() && rig.on());
  push(3, 3);
  ASSERT_TRUE(rig.cycle(milliseconds(10)));
  const double before = qd(0);
  rig.set("inertia", 1e6, 0);
  ASSERT_TRUE(rig.reinit());
  ASSERT_TRUE(rig.cycle(milliseconds(10)));
  EXPECT_NEAR(qd(0), before, 1e-6);
}

TEST_F(ServoAxisTest, ATorqueThatIsNotFiniteOrTooLargeMovesNothing) {
  ASSERT_TRUE(rig.init() && rig.on());
  push(3, std::nan(""));
  EXPECT_EQ(rig.cycle().text, "tau[1] is not a finite number");
  push(3, -2e9);
  EXPECT_EQ(rig.cycle().text, "tau is -1e9 to 1e9 N.m");
  EXPECT_TRUE(rig.error());
  push(0, 0);
  ASSERT_TRUE(rig.cycle());
  EXPECT_EQ(q(0), 1);
}

TEST_F(ServoAxisTest, RefusesConstantsOutsideTheirRange) {
  const auto said = [this](const char* port, double value, double good) {
    rig.set(port, value, 1);
    const std::string text = rig.init().text;
    rig.set(port, good, 1);
    return text;
  };
  EXPECT_EQ(said("inertia", 0, 1), "inertia is 1e-9 to 1e6 kg.m2");
  EXPECT_EQ(said("viscous", -1, 0), "viscous is 0 to 1e6 N.m.s/rad");
  EXPECT_EQ(said("coulomb", std::nan(""), 0), "coulomb is 0 to 1e6 N.m");
  EXPECT_EQ(said("start_pose", 2e6, 0), "start_pose is -1e6 to 1e6 rad");
}

}  // namespace
}  // namespace chimera
