// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <string>

#include "chimera/task/rig.h"

namespace chimera {
namespace {

constexpr std::int64_t kMostCounted = std::int64_t{1} << 53;

struct Counted : Rig {
  explicit Counted(std::uint32_t elements = 1) : Rig("counter") { extent("n", elements); }
  void limits(std::int64_t low, std::int64_t high, std::int64_t preset, bool wraps = false) {
    set("low", low), set("high", high), set("preset", preset), set("wraps", wraps);
  }
  /// Runs one cycle for each letter and returns the last count. u: edge of up, d: edge of down, b: both, r: reset.
  std::int64_t run(const std::string& keys) {
    for (const char key : keys) {
      give(key == 'u' || key == 'b', key == 'd' || key == 'b', key == 'r');
      give(false, false, false);
    }
    return get<std::int64_t>("count");
  }
  void give(bool up, bool down, bool reset) {
    set("up", up), set("down", down), set("reset", reset);
    EXPECT_TRUE(cycle());
  }
};

TEST(Counter, CountsUpAndDown) {
  Counted rig;
  ASSERT_TRUE(rig.init() && rig.on());
  EXPECT_EQ(rig.run("."), 0);
  EXPECT_EQ(rig.run("uuu"), 3);
  EXPECT_EQ(rig.run("ddddd"), -2);
  EXPECT_EQ(rig.run("bb"), -2);
}

TEST(Counter, CountsEdgesNotLevels) {
  Counted rig;
  ASSERT_TRUE(rig.init() && rig.on());
  rig.give(true, false, false);  // true when first read: no edge
  EXPECT_EQ(rig.get<std::int64_t>("count"), 0);
  for (int i = 0; i < 10; ++i)
    for (const bool is_up : {false, true, true}) rig.give(is_up, false, false);
  EXPECT_EQ(rig.get<std::int64_t>("count"), 10);
}

TEST(Counter, BeginsAtThePresetAndGoesBackThere) {
  Counted rig;
  rig.limits(-10, 100, 42);
  ASSERT_TRUE(rig.init() && rig.on());
  EXPECT_EQ(rig.get<std::int64_t>("count"), 42);
  EXPECT_EQ(rig.run(".uu"), 44);
  EXPECT_EQ(rig.run("r"), 42);
  rig.give(false, false, true), rig.give(true, false, true);
  EXPECT_EQ(rig.get<std::int64_t>("count"), 42);  // an edge beside a reset is not counted
}

TEST(Counter, StandsAtItsLimitsOrWraps) {
  Counted rig;
  rig.limits(0, 3, 2);
  ASSERT_TRUE(rig.init() && rig.on());
  EXPECT_EQ(rig.run(".uuu"), 3);
  EXPECT_TRUE(rig.get<bool>("at_high"));
  EXPECT_EQ(rig.run("d"), 2);
  EXPECT_FALSE(rig.get<bool>("at_high"));
  EXPECT_EQ(rig.run("ddddd"), 0);
  rig.limits(0, 3, 2, true);
  ASSERT_TRUE(rig.reinit());
  EXPECT_EQ(rig.run("d"), 3);
  EXPECT_EQ(rig.run("uu"), 1);
  rig.limits(-kMostCounted, kMostCounted, kMostCounted);
  ASSERT_TRUE(rig.reinit());
  EXPECT_EQ(rig.run("ru"), kMostCounted);
}

TEST(Counter, KeepsItsCountAndMissesEdgesWhileOff) {
  Counted rig;
  rig.limits(0, 100, 5);
  ASSERT_TRUE(rig.init() && rig.on());
  EXPECT_EQ(rig.run(".uu"), 7);
  ASSERT_TRUE(rig.off());
  ASSERT_TRUE(rig.on());
  EXPECT_EQ(rig.get<std::int64_t>("count"), 7);
  rig.give(true, false, false);
  EXPECT_EQ(rig.get<std::int64_t>("count"), 7);
}

TEST(Counter, CountsEachElementByItself) {
  Counted rig(2);
  for (std::size_t i = 0; i < 2; ++i) {
    for (const char* port : {"up", "down", "reset"}) rig.set(port, false, i);
    rig.set("low", -kMostCounted, i), rig.set("high", kMostCounted, i), rig.set("preset", std::int64_t{5}, i);
  }
  ASSERT_TRUE(rig.init() && rig.on() && rig.cycle());
  rig.set("up", true, 0), rig.set("down", true, 1);
  ASSERT_TRUE(rig.cycle());
  EXPECT_EQ(rig.get<std::int64_t>("count", 0), 6);
  EXPECT_EQ(rig.get<std::int64_t>("count", 1), 4);
}

TEST(Counter, WaitsForItsInputsAndRefusesWrongConstants) {
  Counted rig;
  ASSERT_TRUE(rig.init() && rig.on());
  EXPECT_EQ(rig.cycle().status, CHIMERA_ABORTED);
  rig.limits(3, 2, 3);
  EXPECT_EQ(rig.init().text, "low must be at most high");
  rig.limits(0, 2, 3);
  EXPECT_EQ(rig.init().text, "preset must be low to high");
  rig.limits(0, kMostCounted + 2, 3);
  EXPECT_EQ(rig.init().text, "low and high must be -2^53 to 2^53");
}

}  // namespace
}  // namespace chimera
