// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <cmath>
#include <string>

#include "chimera/task/rig.h"

namespace chimera {
namespace {

struct Pulses : Rig {
  explicit Pulses(const char* of, double duration = 0, std::uint32_t elements = 1) : Rig("edge") {
    extent("n", elements);
    set("of", Text<16>(of)), set("duration", duration);
  }
  /// Runs a cycle of 1 ms for each bit of x and returns y of each cycle.
  std::string run(const std::string& bits) {
    std::string text;
    for (const char bit : bits) {
      set("x", bit == '1');
      EXPECT_TRUE(cycle());
      text += get<bool>("y") ? '1' : '0';
    }
    return text;
  }
};

TEST(Edge, IsTrueForOneCycleAtTheEdgesThatCount) {
  constexpr std::pair<const char*, const char*> kExpected[] = {
      {"rising", "0010001000"}, {"falling", "0000100010"}, {"both", "0010101010"}};
  for (const auto& [of, expected] : kExpected) {
    Pulses rig(of);
    ASSERT_TRUE(rig.init() && rig.on());
    EXPECT_EQ(rig.run("0011001100"), expected) << of;
  }
}

TEST(Edge, APulseLastsForItsConfiguredTime) {
  Pulses rig("rising", 3e-3);
  ASSERT_TRUE(rig.init() && rig.on());
  EXPECT_EQ(rig.run("011111000"), "011100000");
}

TEST(Edge, AFurtherEdgeWithinMakesThePulseLonger) {
  Pulses rig("rising", 4e-3);
  ASSERT_TRUE(rig.init() && rig.on());
  EXPECT_EQ(rig.run("0101000000"), "0111111000");
}

TEST(Edge, CountsTheTimeOfDroppedReleases) {
  Pulses rig("rising", 3e-3);
  ASSERT_TRUE(rig.init() && rig.on());
  EXPECT_EQ(rig.run("01"), "01");
  ASSERT_TRUE(rig.cycle(milliseconds(4)));
  EXPECT_FALSE(rig.get<bool>("y"));
}

TEST(Edge, AChangeWhileOffAndTheFirstValueAreNoEdges) {
  Pulses rig("both", 5e-3);
  ASSERT_TRUE(rig.init() && rig.on());
  EXPECT_EQ(rig.run("1"), "0");
  EXPECT_EQ(rig.run("0"), "1");
  ASSERT_TRUE(rig.off());
  ASSERT_TRUE(rig.on());
  EXPECT_FALSE(rig.get<bool>("y"));
  EXPECT_EQ(rig.run("1"), "0");
}

TEST(Edge, LooksAtEachElementByItself) {
  Pulses rig("rising", 0, 2);
  rig.set("x", false, 0), rig.set("x", false, 1);
  ASSERT_TRUE(rig.init() && rig.on());
  ASSERT_TRUE(rig.cycle());
  rig.set("x", true, 1);
  ASSERT_TRUE(rig.cycle());
  EXPECT_FALSE(rig.get<bool>("y", 0));
  EXPECT_TRUE(rig.get<bool>("y", 1));
}

TEST(Edge, WaitsForAnInputAndRefusesWrongConstants) {
  Pulses rig("rising");
  ASSERT_TRUE(rig.init() && rig.on());
  EXPECT_EQ(rig.cycle().status, CHIMERA_ABORTED);
  EXPECT_EQ(Pulses("up").init().text, "of must be rising, falling or both");
  EXPECT_EQ(Pulses("both", -1).init().text, "duration must be 0 to 86400 s");
  EXPECT_EQ(Pulses("both", std::nan("")).init().text, "duration must be 0 to 86400 s");
}

}  // namespace
}  // namespace chimera
