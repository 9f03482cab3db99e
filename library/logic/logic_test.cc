// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <string>

#include "chimera/task/rig.h"

namespace chimera {
namespace {

struct Combined : Rig {
  Combined(const char* function, std::uint32_t inputs, std::uint32_t inverted = 0, std::uint32_t elements = 1)
      : Rig("logic") {
    instances("in", inputs), instances("inverted", inverted), extent("n", elements);
    set("function", Text<16>(function));
  }
  bool step(const std::string& bits) {
    for (std::size_t k = 0; k < bits.size(); ++k) set("in", bits[k] == '1', 0, k);
    EXPECT_TRUE(cycle()) << bits;
    return get<bool>("out");
  }
  /// Results for 000, 001, 010 ... of three inputs.
  std::string table() {
    EXPECT_TRUE(init());
    std::string text;
    for (int row = 0; row < 8; ++row) {
      const std::string bits{"01"[row >> 2 & 1], "01"[row >> 1 & 1], "01"[row & 1]};
      text += step(bits) ? '1' : '0';
    }
    return text;
  }
};

TEST(Logic, HasTheTableOfEachFunction) {
  EXPECT_EQ(Combined("and", 3).table(), "00000001");
  EXPECT_EQ(Combined("or", 3).table(), "01111111");
  EXPECT_EQ(Combined("xor", 3).table(), "01101001");
  EXPECT_EQ(Combined("nand", 3).table(), "11111110");
  EXPECT_EQ(Combined("nor", 3).table(), "10000000");
  EXPECT_EQ(Combined("xnor", 3).table(), "10010110");
}

TEST(Logic, TurnsOneInput) {
  Combined rig("not", 1);
  ASSERT_TRUE(rig.init());
  EXPECT_TRUE(rig.step("0"));
  EXPECT_FALSE(rig.step("1"));
}

TEST(Logic, TurnsTheInputsThatAreInverted) {
  Combined rig("and", 3, 3);
  for (std::size_t k = 0; k < 3; ++k) rig.set("inverted", k == 1, 0, k);
  EXPECT_EQ(rig.table(), "00000100");
}

TEST(Logic, ALatchIsSetAndResetAndResetWins) {
  Combined rig("latch", 2);
  ASSERT_TRUE(rig.init());
  EXPECT_FALSE(rig.step("00"));
  EXPECT_TRUE(rig.step("10"));
  EXPECT_TRUE(rig.step("00"));
  EXPECT_FALSE(rig.step("01"));
  EXPECT_FALSE(rig.step("00"));
  EXPECT_FALSE(rig.step("11"));
  EXPECT_TRUE(rig.step("10"));
  ASSERT_TRUE(rig.off());
  rig.set("in", false, 0, 0);
  ASSERT_TRUE(rig.on());
  EXPECT_TRUE(rig.get<bool>("out"));
}

TEST(Logic, CountsEveryElementOfAList) {
  Combined rig("and", 2, 0, 3);
  for (std::size_t i = 0; i < 6; ++i) rig.set("in", true, i % 3, i / 3);
  ASSERT_TRUE(rig.init());
  ASSERT_TRUE(rig.on());
  EXPECT_TRUE(rig.get<bool>("out"));
  rig.set("in", false, 2, 1);
  ASSERT_TRUE(rig.cycle());
  EXPECT_FALSE(rig.get<bool>("out"));
}

TEST(Logic, AbortsItsCycleWhileAnInputIsUnwritten) {
  Combined rig("or", 2);
  rig.set("in", true, 0, 0);
  ASSERT_TRUE(rig.init());
  ASSERT_TRUE(rig.on());
  EXPECT_FALSE(rig.get<bool>("out"));
  EXPECT_EQ(rig.cycle().status, CHIMERA_ABORTED);
}

TEST(Logic, RefusesInputsThatDoNotFitItsFunction) {
  EXPECT_EQ(Combined("and", 0).init().text, "there is nothing to combine: name at least one input");
  EXPECT_EQ(Combined("AND", 2).init().text, "function must be and, or, xor, nand, nor, xnor, not or latch");
  EXPECT_EQ(Combined("not", 2).init().text, "not has one input");
  EXPECT_EQ(Combined("latch", 3).init().text, "a latch has two inputs: the first sets it, the second resets it");
  EXPECT_EQ(Combined("or", 3, 2).init().text, "give one inverted for each input, or none");
}

}  // namespace
}  // namespace chimera
