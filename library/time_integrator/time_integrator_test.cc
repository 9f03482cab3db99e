// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <cmath>

#include "chimera/task/rig.h"

namespace chimera {
namespace {

struct TimeIntegratorTest : testing::Test {
  Rig rig{"time_integrator"};
  void start() {
    rig.extent("n", 2);
    rig.set("start", 1.0, 0);
    rig.set("start", -1.0, 1);
    rig.set("rate_of_change", 2.0, 0);
    rig.set("rate_of_change", 0.0, 1);
    ASSERT_TRUE(rig.init());
    ASSERT_TRUE(rig.on());
  }
};

TEST_F(TimeIntegratorTest, IsTheRectangleSumFromItsStart) {
  start();
  EXPECT_EQ(rig.get<double>("integral", 0), 1);
  for (int i = 0; i < 100; ++i) ASSERT_TRUE(rig.cycle(milliseconds(10)));
  EXPECT_NEAR(rig.get<double>("integral", 0), 3, 1e-12);
  EXPECT_EQ(rig.get<double>("integral", 1), -1);
}

TEST_F(TimeIntegratorTest, StandsWhileTheConfigurationIsIllegal) {
  start();
  rig.illegal(true);
  ASSERT_TRUE(rig.cycle());
  EXPECT_EQ(rig.get<double>("integral", 0), 1);
}

TEST_F(TimeIntegratorTest, AddsNothingThatIsNotFinite) {
  start();
  rig.set("rate_of_change", std::nan(""), 1);
  EXPECT_EQ(rig.cycle().text, "what is integrated is not finite");
  EXPECT_EQ(rig.get<double>("integral", 0), 1);
  rig.set("start", std::nan(""), 0);
  EXPECT_EQ(rig.on().text, "start is not finite");
}

}  // namespace
}  // namespace chimera
