// SPDX-License-Identifier: Apache-2.0
#include "chimera/schedule/policy.h"

#include <gtest/gtest.h>

namespace chimera {
namespace {

const Urgency kSoon{0, 0, milliseconds(20), milliseconds(5), milliseconds(1)};
const Urgency kTight{0, 0, milliseconds(10), milliseconds(9), milliseconds(8)};
const Urgency kCritical{2, 0, milliseconds(40), milliseconds(40), milliseconds(2)};

TEST(Policy, RmLooksAtThePeriodOnly) {
  EXPECT_TRUE(is_more_urgent(Policy::kRm, kTight, kSoon));
  EXPECT_FALSE(is_more_urgent(Policy::kRm, kCritical, kSoon));
}

TEST(Policy, EdfLooksAtTheDeadlineOnly) {
  EXPECT_TRUE(is_more_urgent(Policy::kEdf, kSoon, kTight));
  EXPECT_FALSE(is_more_urgent(Policy::kEdf, kCritical, kTight));
}

TEST(Policy, LlfLooksAtDeadlineMinusRemaining) {
  EXPECT_TRUE(is_more_urgent(Policy::kLlf, kTight, kSoon));
  EXPECT_FALSE(is_more_urgent(Policy::kLlf, kSoon, kTight));
}

TEST(Policy, MufPutsCriticalityBeforeTheDynamicPart) {
  EXPECT_TRUE(is_more_urgent(Policy::kMuf, kCritical, kSoon));
  EXPECT_TRUE(is_more_urgent(Policy::kMufLaxity, kCritical, kTight));
  EXPECT_TRUE(is_more_urgent(Policy::kMuf, kSoon, kTight));
  EXPECT_TRUE(is_more_urgent(Policy::kMufLaxity, kTight, kSoon));
}

TEST(Policy, UserPriorityDecidesATieAndAFullTieHasNoWinner) {
  Urgency raised = kSoon;
  raised.user_priority = 1;
  for (const Policy p : {Policy::kRm, Policy::kEdf, Policy::kLlf, Policy::kMuf, Policy::kMufLaxity}) {
    EXPECT_TRUE(is_more_urgent(p, raised, kSoon));
    EXPECT_FALSE(is_more_urgent(p, kSoon, raised));
    EXPECT_FALSE(is_more_urgent(p, kSoon, kSoon));
  }
}

}  // namespace
}  // namespace chimera
