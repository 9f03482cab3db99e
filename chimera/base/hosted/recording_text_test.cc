// SPDX-License-Identifier: Apache-2.0
#include "chimera/base/hosted/recording_text.h"

#include <gtest/gtest.h>

namespace chimera::recording_text_test {
namespace {

TEST(FieldsOf, SplitsAtEachComma) {
  EXPECT_EQ(fields_of("t(s),,q"), (std::vector<std::string_view>{"t(s)", "", "q"}));
  EXPECT_EQ(fields_of(""), (std::vector<std::string_view>{""}));
}

TEST(ColumnHead, HasANameAndAUnit) {
  const ColumnHead q = column_head("q[0](rad)"), plain = column_head("count"), torque = column_head("m(N.m/(rad))");
  EXPECT_EQ(q.name, "q[0]");
  EXPECT_EQ(q.unit, "rad");
  EXPECT_EQ(plain.name, "count");
  EXPECT_EQ(plain.unit, "");
  EXPECT_EQ(torque.unit, "N.m/(rad)");
}

TEST(ForeignHead, NamesTheCause) {
  const auto starts = [](std::string_view line, const char* cause) { return foreign_head(line).starts_with(cause); };
  for (const char* good : {"t(s),q[0](rad)", "t,q", "t(s)"}) EXPECT_EQ(foreign_head(good), "") << good;
  EXPECT_TRUE(starts("# by hand", "is a comment"));
  EXPECT_TRUE(starts("// by hand", "is a comment"));
  EXPECT_TRUE(starts("\"t(s)\",\"q\"", "has quotes"));
  EXPECT_TRUE(starts("t(s);q", "has ';'"));
  EXPECT_TRUE(starts("t(s)\tq", "has a tab"));
  EXPECT_TRUE(starts("t(s), q", "has a blank"));
  for (const char* rows : {"0,1", "-1e-3,0.5", ".5", "+0,1"}) EXPECT_TRUE(starts(rows, "is a row of numbers")) << rows;
  EXPECT_TRUE(starts("t(ms),q", "the first column is 't(ms)', expected 't(s)', the time in s"));
  EXPECT_TRUE(starts("", "the first column is ''"));
}

TEST(ForeignLine, AcceptsNumbersAndEmptyFields) {
  for (const char* good : {"0,1,-2e-3", "0,,", "0,inf,nan", ""}) EXPECT_EQ(foreign_line(good), "") << good;
  EXPECT_NE(foreign_line("0 ,1"), "");
  EXPECT_NE(foreign_line("0;0,5"), "");
}

TEST(RecordingLine, HasNoByteOrderMarkAndNoCarriageReturn) {
  EXPECT_EQ(recording_line("\xEF\xBB\xBFt(s),q\r"), "t(s),q");
  EXPECT_EQ(recording_line("0,1"), "0,1");
}

}  // namespace
}  // namespace chimera::recording_text_test
