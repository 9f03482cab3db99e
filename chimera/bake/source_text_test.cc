// SPDX-License-Identifier: Apache-2.0
#include "chimera/bake/source_text.h"

#include <gtest/gtest.h>

#include <cstdlib>
#include <limits>

namespace chimera::bake::source_text_test {

TEST(Literal, EscapesWhatATextOfTheCompilerCannotHold) {
  EXPECT_EQ(literal(std::string_view("a\"b\\c\n1\xc3\xa9")), "\"a\\\"b\\\\c\\0121\\303\\251\"");
}

TEST(Literal, KeepsEveryBitOfANumber) {
  for (const double value : {0.1, 1e-300, 5.0, -1e22, std::numeric_limits<double>::denorm_min()})
    EXPECT_EQ(std::strtod(literal(value).c_str(), nullptr), value) << literal(value);
  EXPECT_EQ(literal(5.0), "5.0");
  EXPECT_EQ(literal(-std::numeric_limits<double>::infinity()), "-__builtin_inf()");
}

TEST(Initialiser, LeavesOutDefaults) {
  Initialiser one;
  one.add("a", 1u, 1u).add("b", 2u, 1u).add_id("c", "TaskId", TaskId()).add_id("d", "TaskId", TaskId(3u));
  EXPECT_EQ(one.text(), "{.b = 2, .d = TaskId(3u)}");
}

TEST(Definitions, DefineEqualBytesOnce) {
  Definitions all;
  const std::vector<std::byte> bytes = {std::byte{1}, std::byte{255}};
  EXPECT_EQ(all.bytes(bytes), "kBytes0");
  EXPECT_EQ(all.bytes(bytes), "kBytes0");
  EXPECT_EQ(all.bytes({}), "");
  EXPECT_EQ(all.text(), "alignas(8) constexpr std::byte kBytes0[] = {0x01_b, 0xff_b,};\n");
}

}  // namespace chimera::bake::source_text_test
