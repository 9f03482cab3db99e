// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include "library/signals/testing/signal_rig.h"

namespace chimera {
namespace {

struct DisplayTest : ::testing::Test {
  SignalRig rig{"display", 2};
  void start(const char* title, std::int32_t digits) {
    rig.instances("in", 1);
    rig.set("title", Text<32>(title));
    rig.set("digits", digits);
    ASSERT_TRUE(rig.init());
    ASSERT_TRUE(rig.on());
  }
  std::string printed() {
    testing::internal::CaptureStdout();
    EXPECT_TRUE(rig.background());
    return testing::internal::GetCapturedStdout();
  }
};

TEST_F(DisplayTest, PrintsALineForEachCycleBesideTheCycles) {
  start("q", 4);
  testing::internal::CaptureStdout();
  ASSERT_TRUE(rig.cycle(milliseconds(500)));
  EXPECT_EQ(testing::internal::GetCapturedStdout(), "");  // a cycle does not print
  rig.set("in", 0.25, 0);
  rig.set("in", -1.57079632679, 1);
  ASSERT_TRUE(rig.cycle(milliseconds(500)));
  EXPECT_EQ(printed(), "q 0.500 s nan nan\nq 1.000 s 0.25 -1.571\n");
  EXPECT_EQ(printed(), "");
}

TEST_F(DisplayTest, CountsTheLinesThatFindNoRoomAndGoesOn) {
  start("", 3);
  for (int i = 0; i < 70; ++i) ASSERT_TRUE(rig.cycle());
  EXPECT_EQ(rig.get<std::int64_t>("lines"), 64);
  EXPECT_EQ(rig.get<std::int64_t>("lost"), 6);
  EXPECT_EQ(printed().substr(0, 16), "0.001 s nan nan\n");
  ASSERT_TRUE(rig.cycle());
  EXPECT_EQ(rig.get<std::int64_t>("lines"), 65);
}

TEST_F(DisplayTest, RefusesNothingToShowAndWrongDigits) {
  rig.instances("in", 0);
  EXPECT_EQ(rig.init().text, "there is nothing to show: name at least one input");
  rig.instances("in", 1);
  rig.set("digits", 0);
  EXPECT_EQ(rig.init().text, "digits must be 1 to 17");
}

}  // namespace
}  // namespace chimera
