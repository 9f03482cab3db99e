// SPDX-License-Identifier: Apache-2.0
#include "chimera/schedule/shares.h"

#include <gtest/gtest.h>

namespace chimera {
namespace {

TEST(Shares, AMemberAloneOnItsCpuHasAll) {
  constexpr ShareMember kUnits[] = {{0, 0.2}, {1, 0.5}};
  EXPECT_DOUBLE_EQ(share_of(kUnits, 0, 0.94), 0.94);
  EXPECT_DOUBLE_EQ(share_of(kUnits, 1, 0.94), 0.94);
}

TEST(Shares, NeverLessThanTheBudgetsAndTogetherAll) {
  constexpr ShareMember kUnits[] = {{0, 0.6}, {0, 0.1}, {1, 0.9}, {0, 0}};
  EXPECT_DOUBLE_EQ(share_of(kUnits, 0, 0.94), 0.68);
  EXPECT_DOUBLE_EQ(share_of(kUnits, 1, 0.94), 0.18);
  EXPECT_DOUBLE_EQ(share_of(kUnits, 3, 0.94), 0.08) << "without budgets";
}

TEST(Shares, TooMuchIsCutInProportion) {
  constexpr ShareMember kUnits[] = {{0, 0.8}, {0, 0.4}};
  EXPECT_DOUBLE_EQ(share_of(kUnits, 0, 0.9), 0.6);
  EXPECT_DOUBLE_EQ(share_of(kUnits, 1, 0.9), 0.3);
}

}  // namespace
}  // namespace chimera
