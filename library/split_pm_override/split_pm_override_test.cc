// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <cmath>

#include "chimera/task/rig.h"

namespace chimera {
namespace {

struct SplitPmOverrideTest : ::testing::Test {
  void expect(double fd, double fra, double frb, double fde, double fdw) {
    rig.set("fd", fd);
    rig.set("fra", fra);
    rig.set("frb", frb);
    EXPECT_TRUE(rig.cycle());
    EXPECT_EQ(rig.get<double>("fde"), fde) << fd << ' ' << fra << ' ' << frb;
    EXPECT_EQ(rig.get<double>("fdw"), fdw) << fd << ' ' << fra << ' ' << frb;
  }
  Rig rig{"split_pm_override"};
};

TEST_F(SplitPmOverrideTest, SplitsTheForceOfTheControlWhileNoPedalIsPressed) {
  expect(1500, 0, 0, 1500, 0);
  expect(0, 0, 0, 0, 0);
  expect(-700, 0, 0, 0, 700);
}

TEST_F(SplitPmOverrideTest, FollowsThePedalsAloneWhenOneIsPressed) {
  expect(1500, 900, 0, 900, 0);
  expect(-700, 900, 0, 900, 0);
  expect(1500, 0, 300, 0, 300);
  expect(-700, 0, 300, 0, 300);
  expect(1500, 900, 300, 900, 300);
  expect(1500, 0, 0, 1500, 0);  // and gives the control back at once
}

TEST_F(SplitPmOverrideTest, SplitsFromOnAlready) {
  rig.set("fd", 1500.0);
  rig.set("fra", 0.0);
  rig.set("frb", 300.0);
  ASSERT_TRUE(rig.on());
  EXPECT_EQ(rig.get<double>("fde"), 0);
  EXPECT_EQ(rig.get<double>("fdw"), 300);
}

TEST_F(SplitPmOverrideTest, AnInputThatIsNotFiniteIsAFaultAndLeavesTheOutputs) {
  for (const char* input : {"fd", "fra", "frb"}) {
    expect(1500, 0, 0, 1500, 0);
    rig.set(input, std::nan(""));
    EXPECT_EQ(rig.cycle().text, "fd, fra or frb is not finite") << input;
    EXPECT_EQ(rig.get<double>("fde"), 1500);
    EXPECT_EQ(rig.get<double>("fdw"), 0);
  }
}

}  // namespace
}  // namespace chimera
