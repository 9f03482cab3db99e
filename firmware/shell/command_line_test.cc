// SPDX-License-Identifier: Apache-2.0
#include "firmware/shell/command_line.h"

#include <gtest/gtest.h>

#include <string>

#include "firmware/shell/line_reader.h"

namespace chimera::firmware::command_line_test {
namespace {

TEST(CommandLine, SplitsAtBlanksAndTabs) {
  const CommandLine line = parse(" set \t label  two words ");
  ASSERT_EQ(line.words.size(), 4u);
  EXPECT_EQ(line.command->verb, Verb::kSet);
  EXPECT_EQ(line.operand(0), "label");
  EXPECT_EQ(line.operand(2), "words");
  EXPECT_EQ(line.after_first, "two words");
  EXPECT_EQ(line.fault, LineFault::kNone);
}

TEST(CommandLine, BlanksAloneAreNoCommand) {
  const CommandLine line = parse("  \t ");
  EXPECT_EQ(line.command, nullptr);
  EXPECT_EQ(line.fault, LineFault::kNone);
  EXPECT_TRUE(line.words.empty());
}

TEST(CommandLine, CountsOperands) {
  EXPECT_EQ(parse("STATUS").fault, LineFault::kUnknown);
  EXPECT_EQ(parse("set k").fault, LineFault::kTooFew);
  EXPECT_EQ(parse("get a b").fault, LineFault::kTooMany);
  EXPECT_EQ(parse("on 1 2 3 4 5 6 7 8").fault, LineFault::kNone);
  EXPECT_EQ(parse("on 1 2 3 4 5 6 7 8 9").fault, LineFault::kTooMany);
  EXPECT_EQ(parse("on 1 2 3 4 5 6 7 8 9 10 11 12").fault, LineFault::kTooManyWords);
}

bool add_all(LineReader& reader, std::string_view bytes) {
  bool is_complete = false;
  for (const char c : bytes) is_complete = reader.add(static_cast<std::uint8_t>(c));
  return is_complete;
}

TEST(LineReader, EndsALineAtEitherMark) {
  for (const char* end : {"\r", "\n"}) {
    LineReader reader;
    EXPECT_FALSE(add_all(reader, "\r\n\n"));
    EXPECT_TRUE(add_all(reader, std::string("get k") + end));
    EXPECT_EQ(reader.line(), "get k");
    EXPECT_EQ(reader.fault(), LineReader::Fault::kNone);
  }
}

TEST(LineReader, JudgesLengthAndBytes) {
  const auto fault_of = [](std::string_view bytes) {
    LineReader reader;
    add_all(reader, bytes);
    return reader.fault();
  };
  EXPECT_EQ(fault_of(std::string(96, 'a')), LineReader::Fault::kNone);
  EXPECT_EQ(fault_of(std::string(97, 'a')), LineReader::Fault::kTooLong);
  EXPECT_EQ(fault_of(std::string(200, 'a') + '\x01'), LineReader::Fault::kBadByte);
  EXPECT_EQ(fault_of("\x7f"), LineReader::Fault::kBadByte);
  EXPECT_EQ(fault_of("\xff"), LineReader::Fault::kBadByte);
  EXPECT_EQ(fault_of(std::string_view("\xff\0 ", 3)), LineReader::Fault::kLost);
}

}  // namespace
}  // namespace chimera::firmware::command_line_test
