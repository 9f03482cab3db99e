// SPDX-License-Identifier: Apache-2.0
#include "chimera/base/hosted/wording.h"

#include <gtest/gtest.h>

#include <array>

namespace chimera {
namespace {

const std::vector<std::string> kNames = {"pid", "", "lqr"};

TEST(Wording, JoinsItemsAndKeepsEmptyOnes) {
  EXPECT_EQ(join(kNames, ", "), "pid, , lqr");
  EXPECT_EQ(join(kNames, ", ", in_quotes), "'pid', '', 'lqr'");
  EXPECT_EQ(join(std::vector<std::string>(), ", "), "");
  EXPECT_EQ(join_n(3, "; ", [](std::size_t i) { return std::to_string(i * i); }), "0; 1; 4");
}

TEST(Wording, ReplacesTheLastSeparatorOnly) {
  EXPECT_EQ(join(std::array{"a", "b", "c"}, ", ", {}, " or "), "a, b or c");
  EXPECT_EQ(join(std::array{"a"}, ", ", {}, " or "), "a");
}

TEST(Wording, AppendsASeparatorToAListThatHasItems) {
  std::string list;
  append_joined(list, ", ", "pid");
  append_joined(list, ", ", "lqr");
  EXPECT_EQ(list, "pid, lqr");
}

TEST(Wording, NamesItemsByMember) {
  struct Item {
    std::string_view name;
  };
  EXPECT_EQ(names_of(std::array{Item{"a"}, Item{"b"}}, &Item::name), (std::vector<std::string>{"a", "b"}));
}

TEST(Wording, QuotesForReadersFilesAndShells) {
  EXPECT_EQ(in_double_quotes("a\"b"), "\"a\"b\"");
  EXPECT_EQ(backslashed("a\"b\\c\nd\te"), "\"a\\\"b\\\\c\\nd e\"");
  EXPECT_EQ(shell_word("/opt/a-b_c.d"), "/opt/a-b_c.d");
  EXPECT_EQ(shell_word("it's"), "'it'\\''s'");
  EXPECT_EQ(shell_word(""), "''");
}

TEST(Wording, CountsAndMeasures) {
  EXPECT_EQ(counted(1, "row") + ", " + counted(2, "row") + ", " + counted(0, "leaves", "leave"),
            "1 row, 2 rows, 0 leave");
  EXPECT_EQ(formatted("%.3g Hz", 2.5), "2.5 Hz");
  EXPECT_EQ(with_unit("5", "m/s") + " " + with_unit("5", "1"), "5 m/s 5");
}

}  // namespace
}  // namespace chimera
