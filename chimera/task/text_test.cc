// SPDX-License-Identifier: Apache-2.0
#include "chimera/task/text.h"

#include <gtest/gtest.h>

#include <cstring>
#include <type_traits>

namespace chimera {
namespace {

TEST(Text, HoldsOneLessThanItsBytes) {
  const Text<4> text("abcdef");
  EXPECT_EQ(text.view(), "abc");
  EXPECT_EQ(sizeof(text), 4u);
  EXPECT_EQ(Text<4>::capacity(), 3u);
}

TEST(Text, IsZeroFilledSoThatEqualTextsHaveEqualBytes) {
  Text<8> text("longest");
  text = Text<8>("a");
  const Text<8> other("a");
  EXPECT_EQ(std::memcmp(&text, &other, 8), 0);
}

TEST(Text, ReadsBytesWithoutAnEndAsFull) {
  Text<4> text;
  std::memset(static_cast<void*>(&text), 'x', 4);  // another process may have written this
  EXPECT_EQ(text.view(), "xxx");
}

TEST(Text, ComparesWithLiterals) {
  const Text<8> text("on");
  EXPECT_TRUE(text == "on");
  EXPECT_FALSE(text == "off");
  EXPECT_TRUE(Text<8>().empty());
  static_assert(std::is_trivially_copyable_v<Text<8>>);
}

}  // namespace
}  // namespace chimera
