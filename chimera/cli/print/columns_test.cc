// SPDX-License-Identifier: Apache-2.0
#include "chimera/cli/print/columns.h"

#include <gtest/gtest.h>

namespace chimera::cli {
namespace {

TEST(Columns, EveryColumnIsAsWideAsItsWidestCell) {
  Columns columns({"task", ">cycles", "state"});
  columns.add({"trajectory", "7", "ON"});
  columns.add({"pid", "123456789", ""});
  EXPECT_EQ(columns.text(),
            "task           cycles  state\n"
            "trajectory          7  ON\n"
            "pid         123456789\n");
}

TEST(Columns, LettersAreCountedNotBytes) {
  EXPECT_EQ(width_of("\xc3\xa4\xe2\x96\x81x"), 3u);
  EXPECT_EQ(fitted("\xc3\xa4" "b", 4), "\xc3\xa4" "b  ");
  EXPECT_EQ(fitted("\xc3\xa4\xc3\xa4\xc3\xa4", 2), "\xc3\xa4~");
  EXPECT_EQ(fitted("abc", 5, true), "  abc");
  EXPECT_EQ(fitted("abc", 0), "");
  EXPECT_EQ(fitted("abc", 1), "~");
}

}  // namespace
}  // namespace chimera::cli
