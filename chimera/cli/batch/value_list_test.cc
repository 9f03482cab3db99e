// SPDX-License-Identifier: Apache-2.0
#include "chimera/cli/batch/value_list.h"

#include <gtest/gtest.h>

namespace chimera::cli {
namespace {

using Texts = std::vector<std::string>;

Texts values(const std::string& text) {
  const auto list = parse_value_list(text);
  return list ? list->values : Texts{list.error().message.c_str()};
}

TEST(ValueList, AValueWithoutAUnitHasThatOfTheLast) {
  const auto list = parse_value_list("kp = 1, 2.5,  -3 N.m/rad");
  ASSERT_TRUE(list);
  EXPECT_EQ(list->name, "kp");
  EXPECT_EQ(list->values, (Texts{"1 N.m/rad", "2.5 N.m/rad", "-3 N.m/rad"}));
  EXPECT_EQ(list->shown, (Texts{"1", "2.5", "-3"}));
  EXPECT_EQ(list->unit, "N.m/rad");
  EXPECT_EQ(list->numbers, (std::vector<double>{1, 2.5, -3}));
}

TEST(ValueList, ARangeHasBothItsEndsAsAPersonWritesThem) {
  EXPECT_EQ(values("k=[0.1:0.1:0.5] V"), (Texts{"0.1 V", "0.2 V", "0.3 V", "0.4 V", "0.5 V"}));
  EXPECT_EQ(values("k = [1:-0.5:-0.5]"), (Texts{"1", "0.5", "0", "-0.5"}));
  EXPECT_EQ(values("k = [1:2:6]"), (Texts{"1", "3", "5"}));
  EXPECT_EQ(values("k = 0, [1:1:3], 10 V"), (Texts{"0 V", "1 V", "2 V", "3 V", "10 V"}));
}

TEST(ValueList, ListsTextsAndUnitsOfTheirOwnStayWhole) {
  EXPECT_EQ(values("kp = [1 2], [3 4] N.m/rad"), (Texts{"[1 2] N.m/rad", "[3 4] N.m/rad"}));
  EXPECT_EQ(values("kp = [1, 2], [3, 4]"), (Texts{"[1, 2]", "[3, 4]"}));
  const auto texts = parse_value_list("wave.form = sine, square");
  ASSERT_TRUE(texts);
  EXPECT_EQ(texts->values, (Texts{"sine", "square"}));
  EXPECT_TRUE(texts->numbers.empty());
  const auto mixed = parse_value_list("x = 500 mm, 1 m");
  ASSERT_TRUE(mixed);
  EXPECT_EQ(mixed->shown, (Texts{"500 mm", "1 m"}));
  EXPECT_EQ(mixed->unit, "");
  EXPECT_TRUE(mixed->numbers.empty()) << "the values have different units";
}

TEST(ValueList, AListForANameOfOneElementListsItsValues) {
  const auto single = [](const std::string& name) { return name == "kp"; };
  EXPECT_EQ(parse_value_list("kp = [15 25] 1/s", single)->values, (Texts{"15 1/s", "25 1/s"}));
  EXPECT_EQ(parse_value_list("kp = [15, 25], 30 1/s", single)->values, (Texts{"15 1/s", "25 1/s", "30 1/s"}));
  EXPECT_EQ(parse_value_list("q = [15 25] rad", single)->values, Texts{"[15 25] rad"});
  EXPECT_FALSE(parse_value_list("kp = []", single));
}

TEST(ValueList, RefusesAMalformedList) {
  const std::string form = "write 'NAME = VALUE, VALUE UNIT' or 'NAME = [FIRST:STEP:LAST] UNIT'";
  EXPECT_EQ(values("kp"), Texts{"--over 'kp': " + form});
  EXPECT_EQ(values("= 1"), Texts{"--over '= 1': " + form});
  EXPECT_EQ(values("kp ="), Texts{"--over 'kp =': a value is missing"});
  EXPECT_EQ(values("kp = 1,,2"), Texts{"--over 'kp = 1,,2': a value is missing"});
  EXPECT_EQ(values("kp = [1:2]"),
            Texts{"--over 'kp = [1:2]': write a range as '[FIRST:STEP:LAST] UNIT', such as '[0.1:0.1:1] V'"});
  EXPECT_EQ(values("kp = 1:1:3 V"),
            Texts{"--over 'kp = 1:1:3 V': write a range as '[FIRST:STEP:LAST] UNIT', such as '[0.1:0.1:1] V'"});
  EXPECT_EQ(values("kp = [1:0:2]"),
            Texts{"--over 'kp = [1:0:2]': the range [1:0:2] does not come from its first to its last value"});
  EXPECT_EQ(values("kp = [2:1:1]"),
            Texts{"--over 'kp = [2:1:1]': the range [2:1:1] does not come from its first to its last value"});
  EXPECT_EQ(values("kp = [0:1:1e9]"),
            Texts{"--over 'kp = [0:1:1e9]': the range [0:1:1e9] has more than 100000 values"});
}

}  // namespace
}  // namespace chimera::cli
