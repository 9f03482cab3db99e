// SPDX-License-Identifier: Apache-2.0
#include "library/script/script.h"

#include <gtest/gtest.h>

#include <string>

namespace chimera::library {
namespace {

TEST(Script, HoldsEachValueUntilTheNextPoint) {
  Script script;
  ASSERT_EQ(script.read("0:1 5:0.4  8:-2"), nullptr);
  EXPECT_EQ(script.step(-1), 1);
  EXPECT_EQ(script.step(0), 1);
  EXPECT_EQ(script.step(4.999), 1);
  EXPECT_EQ(script.step(5), 0.4);
  EXPECT_EQ(script.step(1e9), -2);
}

TEST(Script, DrawsStraightLinesBetweenPoints) {
  Script script;
  ASSERT_EQ(script.read("100:0 200:0.04"), nullptr);
  EXPECT_EQ(script.line(0), 0);
  EXPECT_DOUBLE_EQ(script.line(150), 0.02);
  EXPECT_EQ(script.line(200), 0.04);
  EXPECT_EQ(script.line(300), 0.04);
}

TEST(Script, HoldsItsValuesToARange) {
  Script script;
  EXPECT_EQ(script.read("0:1 5:-2", -2, 1, "too much"), nullptr);
  EXPECT_EQ(script.step(5), -2);
  EXPECT_STREQ(script.read("0:1 5:-2", -1.9, 1, "too much"), "too much");
  EXPECT_EQ(script.step(0), 0);
  EXPECT_STREQ(script.read("0:1.1 5:-2", -2, 1, "too much"), "too much");
  EXPECT_STREQ(script.read("", -2, 1, "too much"), "the script is empty: write at:value at:value ...");
}

TEST(Script, NamesTheError) {
  Script script;
  EXPECT_STREQ(script.read(""), "the script is empty: write at:value at:value ...");
  EXPECT_STREQ(script.read("x:1"), "a point of the script does not begin with a number");
  EXPECT_STREQ(script.read("inf:1"), "a point of the script does not begin with a number");
  EXPECT_STREQ(script.read("0=1"), "a point of the script has no ':' after its first number");
  EXPECT_STREQ(script.read("0:"), "a point of the script has no number after ':'");
  EXPECT_STREQ(script.read("0:nan"), "a point of the script has no number after ':'");
  EXPECT_STREQ(script.read("0:1,2:3"), "a point of the script does not end with its second number");
  EXPECT_STREQ(script.read("0:1 0:2"), "the points of the script do not rise");
  std::string long_script;
  for (int i = 0; i < 33; ++i) long_script += std::to_string(i) + ":0 ";
  EXPECT_STREQ(script.read(long_script), "the script has more than 32 points");
  EXPECT_EQ(script.step(0), 0);
}

}  // namespace
}  // namespace chimera::library
