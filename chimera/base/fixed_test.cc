// SPDX-License-Identifier: Apache-2.0
#include "chimera/base/fixed.h"

#include <gtest/gtest.h>

#include <type_traits>

namespace chimera {
namespace {

TEST(FixedString, KeepsShortTextWhole) {
  FixedString<8> text("servo");
  EXPECT_EQ(text.view(), "servo");
  EXPECT_STREQ(text.c_str(), "servo");
}

TEST(FixedString, CutsLongText) {
  FixedString<4> text("trajectory");
  EXPECT_EQ(text.view(), "traj");
  text.assign("pid");
  EXPECT_EQ(text.view(), "pid");
}

TEST(FixedString, IsPlainBytes) { EXPECT_TRUE(std::is_trivially_copyable_v<FixedString<16>>); }

TEST(FixedVector, RefusesAValueThatDoesNotFit) {
  FixedVector<int, 2> numbers;
  EXPECT_TRUE(numbers.try_push(1));
  EXPECT_TRUE(numbers.try_push(2));
  EXPECT_FALSE(numbers.try_push(3));
  EXPECT_EQ(numbers.size(), 2u);
  EXPECT_EQ(numbers[1], 2);
}

TEST(FixedVectorDeath, IndexBeyondTheEndIsABug) {
  FixedVector<int, 2> numbers;
  EXPECT_DEATH((void)numbers[0], "size_");
}

}  // namespace
}  // namespace chimera
