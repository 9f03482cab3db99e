// SPDX-License-Identifier: Apache-2.0
#include "chimera/runtime/safe_condition.h"

#include <gtest/gtest.h>

#include <limits>
#include <string>

namespace chimera::safe_condition_test {
namespace {

std::string holds_at(Relation comparison) {
  std::string found;
  for (const double value : {1.0, 2.0, 3.0})
    found += is_safe({VariableId{0u}, 0, comparison, 2}, value) ? 'y' : 'n';
  return found;
}

TEST(SafeCondition, ComparesWithItsLimit) {
  EXPECT_EQ(holds_at(Relation::kLess), "ynn");
  EXPECT_EQ(holds_at(Relation::kAtMost), "yyn");
  EXPECT_EQ(holds_at(Relation::kMore), "nny");
  EXPECT_EQ(holds_at(Relation::kAtLeast), "nyy");
  EXPECT_EQ(holds_at(Relation::kEqual), "nyn");
  EXPECT_EQ(holds_at(Relation::kUnequal), "yny");
}

TEST(SafeCondition, NotANumberIsNeverSafe) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  for (int c = 0; c <= static_cast<int>(Relation::kUnequal); ++c)
    EXPECT_FALSE(is_safe({VariableId{0u}, 0, static_cast<Relation>(c), 2}, nan)) << c;
  EXPECT_TRUE(is_safe({VariableId{0u}, 0, Relation::kMore, 2}, std::numeric_limits<double>::infinity()));
}

TEST(SafeCondition, IsAskedOnlyWhereThereIsAVariable) {
  EXPECT_FALSE(SafeCondition{}.is_there());
  EXPECT_TRUE((SafeCondition{VariableId{0u}, 0, Relation::kLess, 1}.is_there()));
}

}  // namespace
}  // namespace chimera::safe_condition_test
