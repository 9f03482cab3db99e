// SPDX-License-Identifier: Apache-2.0
#include "chimera/base/result.h"

#include <gtest/gtest.h>

#include <memory>
#include <string>

namespace chimera {
namespace {

TEST(Result, HoldsAValueOrAnError) {
  Result<int> good = 7;
  Result<int> bad = Error{ErrorCode::kNotFound, {"no such port"}, {"arm.yaml:3:4"}};
  ASSERT_TRUE(good);
  EXPECT_EQ(*good, 7);
  ASSERT_FALSE(bad);
  EXPECT_EQ(bad.error().message.view(), "no such port");
  EXPECT_EQ(bad.error().where.view(), "arm.yaml:3:4");
}

TEST(Result, MovesAValueOut) {
  Result<std::unique_ptr<int>> owned = std::make_unique<int>(3);
  std::unique_ptr<int> taken = *std::move(owned);
  EXPECT_EQ(*taken, 3);
}

TEST(Result, AResultOfVoidIsTrueOnSuccessOnly) {
  EXPECT_TRUE(Result<void>{});
  EXPECT_FALSE(Result<void>{Error{}});
}

TEST(ResultDeath, ReadingTheMissingHalfIsABug) {
  Result<int> bad = Error{};
  EXPECT_DEATH((void)bad.value(), "has_value");
  Result<int> good = 1;
  EXPECT_DEATH((void)good.error(), "has_value");
}

}  // namespace
}  // namespace chimera
