// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "library/signals/testing/signal_rig.h"

namespace chimera {
namespace {

struct ComparatorTest : ::testing::Test {
  SignalRig rig{"comparator"};

  void give(const char* when, double width, double hysteresis) {
    rig.set("when", Text<16>(when)), rig.set("width", width), rig.set("hysteresis", hysteresis);
    rig.set("level", 10.0);
  }
  /// y after each of the values, as '1' and '0'; '?' where the cycle failed.
  std::string answers(const std::vector<double>& values) {
    std::string text;
    for (double x : values) {
      rig.set("x", x);
      text += !rig.cycle() ? '?' : rig.get<bool>("y") ? '1' : '0';
    }
    return text;
  }
  std::string run(const char* when, double width, double hysteresis, const std::vector<double>& values) {
    give(when, width, hysteresis);
    rig.set("y", false);
    const RigAnswer made = rig.init();
    return made ? answers(values) : made.text;
  }
};

TEST_F(ComparatorTest, ComparesWithTheLevel) {
  EXPECT_EQ(run("above", 0, 0, {9, 10, 10.1, 10, 9}), "00100");
  EXPECT_EQ(run("below", 0, 0, {11, 10, 9.9, 10, 11}), "00100");
}

TEST_F(ComparatorTest, KeepsItsAnswerWithinTheHysteresis) {
  EXPECT_EQ(run("above", 0, 2, {9.5, 10.5, 11, 11.1, 10.5, 9.1, 9, 10.5}), "00011100");
  EXPECT_EQ(run("below", 0, 2, {10.5, 9.5, 9, 8.9, 9.5, 10.9, 11, 9.5}), "00011100");
}

TEST_F(ComparatorTest, ComparesWithTheBandAboutTheLevel) {
  EXPECT_EQ(run("inside", 2, 0, {7.9, 8, 10, 12, 12.1}), "01110");
  EXPECT_EQ(run("outside", 2, 0, {7.9, 8, 10, 12, 12.1}), "10001");
  EXPECT_EQ(run("inside", 2, 1, {7, 8, 8.4, 8.5, 8, 7.5, 7.4, 10, 12.5, 12.6, 12, 11.5}), "000111011001");
  EXPECT_EQ(run("outside", 2, 1, {10, 12, 12.6, 12, 11.6, 11.5, 8, 7.4, 8, 8.5}), "0011100110");
}

TEST_F(ComparatorTest, FollowsALevelThatMoves) {
  EXPECT_EQ(run("above", 0, 0, {11}), "1");
  rig.set("level", 12.0);
  EXPECT_EQ(answers({11}), "0");
}

TEST_F(ComparatorTest, StartsAtItsLastAnswer) {
  give("above", 0, 2);
  ASSERT_TRUE(rig.init());
  EXPECT_EQ(answers({12}), "1");
  ASSERT_TRUE(rig.off());
  rig.set("x", 9.5);
  ASSERT_TRUE(rig.on());
  EXPECT_TRUE(rig.get<bool>("y"));
}

TEST_F(ComparatorTest, ComparesEachElementByItself) {
  SignalRig list("comparator", 2);
  list.set("level", 1.0, 0), list.set("level", 2.0, 1);
  list.set("x", 1.5, 0), list.set("x", 1.5, 1);
  ASSERT_TRUE(list.init());
  ASSERT_TRUE(list.cycle());
  EXPECT_TRUE(list.get<bool>("y", 0));
  EXPECT_FALSE(list.get<bool>("y", 1));
}

TEST_F(ComparatorTest, NaNIsAFaultOfThatCycleAlone) {
  EXPECT_EQ(run("above", 0, 0, {11, std::nan(""), HUGE_VAL, 11, 9}), "1??10");
  EXPECT_EQ(rig.get<bool>("y"), false);
  rig.set("level", std::nan(""));
  EXPECT_EQ(rig.cycle().text, "level is not a finite number");
  EXPECT_TRUE(rig.error());
  EXPECT_EQ(SignalRig("comparator").cycle().status, CHIMERA_ABORTED);
}

TEST_F(ComparatorTest, RefusesConstantsThatNeverTrigger) {
  EXPECT_EQ(run("over", 0, 0, {}), "when must be above, below, inside or outside");
  EXPECT_EQ(run("above", 0, -1, {}), "width and hysteresis must be 0 or more");
  EXPECT_EQ(run("above", std::nan(""), 0, {}), "width and hysteresis must be 0 or more");
  EXPECT_EQ(run("inside", 0, 0, {}), "a band has a width above 0");
  EXPECT_EQ(run("outside", 1, 2.1, {}), "hysteresis must be at most twice the width");
  EXPECT_EQ(run("outside", 1, 2, {10, 12, 10}), "000");
}

}  // namespace
}  // namespace chimera
