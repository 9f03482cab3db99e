// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include "library/signals/testing/signal_rig.h"

namespace chimera {
namespace {

struct WatchdogTest : ::testing::Test {
  SignalRig rig{"watchdog"};
  RigAnswer make(const char* action, const char* target = "") {
    rig.instances("in", 2);
    rig.set("max_age", 0.01);
    rig.set("action", Text<16>(action));
    rig.set("target", Text<64>(target));
    return rig.init();
  }
  void start(const char* action, const char* target = "") {
    const RigAnswer made = make(action, target);
    ASSERT_TRUE(made) << made.text;
    ASSERT_TRUE(rig.on());
  }
  void renew(std::size_t input) { rig.set("in", 1.0, 0, input); }
  bool alive() { return rig.get<bool>("alive"); }
};

TEST_F(WatchdogTest, SaysWhichManyAreLateAndWhenTheyAreRenewed) {
  start("report");
  renew(0), renew(1);
  for (int ms = 1; ms <= 10; ++ms) {
    ASSERT_TRUE(rig.cycle());
    ASSERT_TRUE(alive()) << ms;
  }
  renew(1);
  ASSERT_TRUE(rig.cycle());
  EXPECT_FALSE(alive());
  EXPECT_EQ(rig.get<std::int32_t>("late"), 1);
  EXPECT_NEAR(rig.get<double>("oldest"), 0.011, 1e-12);
  ASSERT_TRUE(rig.cycle());
  EXPECT_EQ(rig.get<std::int64_t>("alarms"), 1);  // once for each failure
  renew(0);
  ASSERT_TRUE(rig.cycle());
  EXPECT_TRUE(alive());
}

TEST_F(WatchdogTest, GivesAnUnwrittenInputMaxAgeFromOn) {
  start("report");
  renew(1);
  for (int ms = 1; ms <= 10; ++ms) ASSERT_TRUE(rig.cycle());
  EXPECT_TRUE(alive());
  ASSERT_TRUE(rig.cycle());
  EXPECT_FALSE(alive());
  ASSERT_TRUE(rig.off());
  ASSERT_TRUE(rig.on());
  ASSERT_TRUE(rig.cycle());
  EXPECT_TRUE(alive());  // max_age counts from `on` again
}

TEST_F(WatchdogTest, AsAFaultNamesTheLateInputAndClearBringsItBack) {
  start("fault");
  renew(0);
  ASSERT_TRUE(rig.cycle(milliseconds(5)));
  renew(0);
  EXPECT_EQ(rig.cycle(milliseconds(10)).text, "in[1] has not been renewed for 0.015 s");
  EXPECT_TRUE(rig.clear());
}

TEST_F(WatchdogTest, TurnsItsTargetOffOnce) {
  start("off", "arm");
  ASSERT_TRUE(rig.cycle(milliseconds(20)));
  ASSERT_TRUE(rig.cycle(milliseconds(20)));
  EXPECT_EQ(rig.signals(), std::vector<std::string>{"off arm"});
}

TEST_F(WatchdogTest, TakesNaNForAlive) {
  start("report");
  renew(0);
  rig.set("in", std::nan(""), 0, 1);
  ASSERT_TRUE(rig.cycle());
  EXPECT_TRUE(alive());
}

TEST_F(WatchdogTest, RefusesWrongConstants) {
  EXPECT_EQ(make("bark").text, "action must be report, fault or off");
  EXPECT_EQ(make("off").text, "the action off needs a target, the others have none");
  EXPECT_EQ(make("report", "arm").text, "the action off needs a target, the others have none");
  ASSERT_TRUE(make("report"));
  rig.set("max_age", std::nan(""));
  EXPECT_EQ(rig.init().text, "max_age must be 0.000001 to 86400 s");
  rig.instances("in", 0);
  EXPECT_EQ(rig.init().text, "there is nothing to watch: name at least one input");
}

}  // namespace
}  // namespace chimera
