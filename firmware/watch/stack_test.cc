// SPDX-License-Identifier: Apache-2.0
#include "firmware/watch/stack.h"

#include <gtest/gtest.h>

#include <array>

namespace chimera::firmware::stack_test {
namespace {

TEST(Stack, GuardIsWholeUntilOneOfItsWordsIsWritten) {
  std::array<std::uint32_t, 32> words{};
  const Stack stack{"main", words};
  EXPECT_FALSE(stack.is_guard_whole()) << "not painted";
  paint(words);
  EXPECT_TRUE(stack.is_guard_whole());
  words[kGuardWords] = 0;
  EXPECT_TRUE(stack.is_guard_whole());
  words[kGuardWords - 1] ^= 1;
  EXPECT_FALSE(stack.is_guard_whole());
}

TEST(StackScan, CountsTheDeepestUseInPieces) {
  std::array<std::uint32_t, 100> words{};
  paint(words);
  words[70] = 0;
  words[90] = 0;
  StackScan scan(Stack{"main", words});
  EXPECT_FALSE(scan.go_on(70));
  EXPECT_TRUE(scan.go_on(1));
  EXPECT_EQ(scan.used_bytes(), 120u);
}

TEST(StackScan, UnusedStackHasNoUsedBytes) {
  std::array<std::uint32_t, 10> words{};
  paint(words);
  StackScan scan(Stack{"main", words});
  EXPECT_TRUE(scan.go_on(10));
  EXPECT_EQ(scan.used_bytes(), 0u);
}

}  // namespace
}  // namespace chimera::firmware::stack_test
