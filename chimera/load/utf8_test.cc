// SPDX-License-Identifier: Apache-2.0
#include "chimera/load/utf8.h"

#include <gtest/gtest.h>

namespace chimera {
namespace {

TEST(Utf8, AcceptsText) {
  for (const char* text :
       {"", "plain", "\xc2\xb5", "\xe2\x82\xac", "\xf0\x9f\x99\x82", "\xf4\x8f\xbf\xbf", "\xef\xbf\xbf"}) {
    EXPECT_TRUE(is_utf8(text)) << text;
  }
}

TEST(Utf8, RefusesBytesThatAreNoUtf8) {
  for (const char* bytes : {"\x80", "\xc2", "\xc0\x80", "\xc1\xbf", "\xe0\x80\x80", "\xed\xa0\x80", "\xf0\x80\x80\x80",
                            "\xf4\x90\x80\x80", "\xf5\x80\x80\x80", "\xff", "\xc2\x41", "\xe2\x82"}) {
    EXPECT_FALSE(is_utf8(bytes));
  }
  EXPECT_FALSE(is_utf8(std::string_view("a\0b", 3)));
}

}  // namespace
}  // namespace chimera
