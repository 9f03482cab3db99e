// SPDX-License-Identifier: Apache-2.0
#include "chimera/base/time.h"

#include <gtest/gtest.h>

#include "chimera/base/ids.h"

namespace chimera {
namespace {

TEST(Nanoseconds, AddsSubtractsAndCounts) {
  EXPECT_EQ(milliseconds(3) + microseconds(2), Nanoseconds{3'002'000});
  EXPECT_EQ(seconds(1) / milliseconds(3), 333);
  EXPECT_EQ(milliseconds(2) * 3, milliseconds(6));
  EXPECT_LT(seconds(1'000'000), kNever);
  EXPECT_DOUBLE_EQ(to_seconds(milliseconds(250)), 0.25);
}

TEST(Id, StartsInvalidAndIsOrderedByIndex) {
  EXPECT_FALSE(TaskId{}.is_valid());
  EXPECT_LT(TaskId{std::size_t{1}}, TaskId{std::size_t{2}});
}

}  // namespace
}  // namespace chimera
