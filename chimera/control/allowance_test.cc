// SPDX-License-Identifier: Apache-2.0
#include "chimera/control/allowance.h"

#include <gtest/gtest.h>

namespace chimera::control {
namespace {

TEST(Allowance, GivesTheBurstAndThenTheRate) {
  Allowance allowance(100, 5);
  Nanoseconds now = seconds(1);
  for (int i = 0; i < 5; ++i) EXPECT_TRUE(allowance.try_take(now));
  EXPECT_FALSE(allowance.try_take(now));
  EXPECT_EQ(allowance.wait(now), milliseconds(10));
  EXPECT_FALSE(allowance.try_take(now += milliseconds(9)));
  EXPECT_EQ(allowance.wait(now), milliseconds(1));
  EXPECT_TRUE(allowance.try_take(now += milliseconds(1)));
  EXPECT_FALSE(allowance.try_take(now));
}

TEST(Allowance, SavesNoMoreThanTheBurst) {
  Allowance allowance(100, 5);
  EXPECT_TRUE(allowance.try_take(seconds(1), 5));
  EXPECT_TRUE(allowance.try_take(seconds(1'000'000'000), 5));
  EXPECT_FALSE(allowance.try_take(seconds(1'000'000'000)));
}

TEST(Allowance, TakesSeveralOrNone) {
  Allowance allowance(100, 5);
  EXPECT_TRUE(allowance.try_take(seconds(1), 3));
  EXPECT_FALSE(allowance.try_take(seconds(1), 3));
  EXPECT_EQ(allowance.wait(seconds(1), 3), milliseconds(10));
  EXPECT_TRUE(allowance.try_take(seconds(1), 2));
}

}  // namespace
}  // namespace chimera::control
