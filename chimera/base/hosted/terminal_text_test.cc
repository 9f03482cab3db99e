// SPDX-License-Identifier: Apache-2.0
#include "chimera/base/hosted/terminal_text.h"

#include <gtest/gtest.h>

namespace chimera {
namespace {

TEST(TerminalText, ALineHasNoControlCharacters) {
  EXPECT_EQ(plain_line("a\x1b[2Jb\nc\x7f" "d"), "a [2Jb c d");
  EXPECT_EQ(plain_line("a\xc2\x9b" "2Jb"), "a 2Jb") << "CSI in one character";
  EXPECT_EQ(plain_line("a\x9b" "2Jb"), "a 2Jb") << "as a byte that is no UTF-8";
  EXPECT_EQ(plain_line("\xc2\xb5m \xe2\x82\xac \xf0\x9f\x98\x80"), "\xc2\xb5m \xe2\x82\xac \xf0\x9f\x98\x80");
}

TEST(TerminalText, ALineHasNoMarksOfDirectionAndNothingUnseen) {
  for (const char* mark : {"\u061c", "\u200b", "\u200e", "\u200f", "\u2028", "\u2029", "\u202a", "\u202e", "\u2060",
                           "\u2066", "\u2069", "\ufeff"})
    EXPECT_EQ(plain_line(std::string("a") + mark + "b"), "a b") << mark;
  EXPECT_EQ(plain_line("\u2010\u2030\u2070"), "\u2010\u2030\u2070") << "their neighbours are letters";
  EXPECT_EQ(plain_line("\xe2\x80"), "  ") << "cut short";
}

TEST(TerminalText, OutputOfACommandKeepsItsLines) {
  EXPECT_EQ(for_terminal("a\tb\n\x1b[2Jc\r\n"), "a\tb\n [2Jc \n");
}

TEST(TerminalText, JsonKeepsItsValuesByEscapes) {
  EXPECT_EQ(for_terminal("{\"doc\": \"\u202e\x7f\u009b\u00b5\"}\n"), "{\"doc\": \"\\u202e\\u007f\\u009b\u00b5\"}\n");
}

}  // namespace
}  // namespace chimera
