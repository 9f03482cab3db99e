// SPDX-License-Identifier: Apache-2.0
#include "chimera/rtpu/group_claims.h"

#include <gtest/gtest.h>

namespace chimera {
namespace {

struct GroupClaimsTest : ::testing::Test {
  GroupClaimsTest() {
    keeper.n_rtpus = 2;
    keeper.alive[0] = 1;
    keeper.alive[1] = 5;
  }
  DecisionPage decision;
  KeeperPage keeper;
  GroupClaims first{decision, keeper, 0, 1}, second{decision, keeper, 1, 5};
};

TEST_F(GroupClaimsTest, OneRtpuAtATimeHasAGroup) {
  EXPECT_TRUE(first.take(0));
  EXPECT_TRUE(first.take(0)) << "the claim is its own";
  EXPECT_FALSE(second.take(0));
  EXPECT_TRUE(second.take(1));
  first.give_back();
  EXPECT_TRUE(second.take(0));
  second.give_back();
  EXPECT_EQ(decision.claims[0], 0u);
  EXPECT_EQ(decision.claims[1], 0u);
}

TEST_F(GroupClaimsTest, AClaimOfADeadProcessIsFree) {
  EXPECT_TRUE(first.take(0));
  keeper.alive[0] = 0;
  EXPECT_TRUE(second.take(0));
  keeper.alive[0] = 2;  // its successor
  first.give_back();
  EXPECT_NE(decision.claims[0], 0u) << "the claim is of its successor now";
}

TEST_F(GroupClaimsTest, AnInvalidClaimHoldsNoGroup) {
  decision.claims[0] = ~std::uint64_t{0};
  EXPECT_TRUE(first.take(0));
  EXPECT_FALSE(first.take(kMaxGroups));
}

TEST_F(GroupClaimsTest, NoClaimSucceedsWhileTheRunEnds) {
  keeper.ending = 1;
  EXPECT_FALSE(first.take(0));
}

}  // namespace
}  // namespace chimera
