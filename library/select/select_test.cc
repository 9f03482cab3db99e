// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include "library/signals/testing/signal_rig.h"

namespace chimera {
namespace {

struct SelectTest : ::testing::Test {
  SignalRig rig{"select"};
  void start(std::uint32_t inputs) {
    rig.instances("in", inputs);
    for (std::size_t i = 0; i < inputs; ++i) rig.set("in", 10.0 * static_cast<double>(i), 0, i);
    ASSERT_TRUE(rig.init());
  }
};

TEST_F(SelectTest, HandsOnTheInputThatTheNumberNames) {
  start(3);
  rig.set("which", 2);
  ASSERT_TRUE(rig.on());
  EXPECT_EQ(rig.get<double>("out"), 20);
  rig.set("which", 1);
  ASSERT_TRUE(rig.cycle());
  EXPECT_EQ(rig.get<double>("out"), 10);
}

TEST_F(SelectTest, ANumberThatNamesNoneIsAFaultAndTheOutputStands) {
  start(3);
  rig.set("which", 1);
  ASSERT_TRUE(rig.cycle());
  for (std::int32_t which : {3, -1, 99}) {
    rig.set("which", which);
    EXPECT_EQ(rig.cycle().text, "which is " + std::to_string(which) + ", and there are 3 inputs");
    EXPECT_TRUE(rig.error());
    EXPECT_EQ(rig.get<double>("out"), 10);
  }
}

TEST_F(SelectTest, LooksAtTheChosenInputOnly) {
  start(12);
  rig.set("in", std::nan(""), 0, 11);
  rig.set("which", 0);
  ASSERT_TRUE(rig.cycle());
  rig.set("which", 11);
  EXPECT_EQ(rig.cycle().text, "in[11] is not a finite number");
}

TEST_F(SelectTest, WaitsForTheNumber) {
  start(2);
  ASSERT_TRUE(rig.on());
  EXPECT_EQ(rig.cycle().status, CHIMERA_ABORTED);
}

TEST_F(SelectTest, RefusesNothingToChooseFrom) {
  rig.instances("in", 0);
  EXPECT_EQ(rig.init().text, "there is nothing to choose from: name at least one input");
}

}  // namespace
}  // namespace chimera
