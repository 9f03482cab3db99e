// SPDX-License-Identifier: Apache-2.0
#include "chimera/control/places.h"

#include <gtest/gtest.h>

#include <vector>

#include "chimera/control/limits.h"

namespace chimera::control {
namespace {

struct PlacesTest : ::testing::Test {
  /// `n` of a user; numbers count from 1 in the order of arrival.
  void sit(std::size_t n, uid_t user, Rank rank, Standing standing = Standing::kIdle, Nanoseconds since = seconds(1)) {
    for (std::size_t i = 0; i < n; ++i) all.push_back({all.size() + 1, user, rank, standing, since});
  }
  /// Adds connections, each of another user.
  void crowd(std::size_t n, Rank rank, Standing standing = Standing::kIdle) {
    for (std::size_t i = 0; i < n; ++i) sit(1, 5000 + static_cast<uid_t>(all.size()), rank, standing);
  }
  std::string refusal(uid_t user, Rank rank) const { return find_place(all, user, rank).refusal; }
  std::uint64_t in_place_of(uid_t user, Rank rank) const {
    const PlaceGrant placement = find_place(all, user, rank);
    EXPECT_TRUE(placement.is_granted) << placement.refusal;
    return placement.in_place_of;
  }
  std::vector<Occupant> all;
};

TEST_F(PlacesTest, RootAndTheUserOfTheSubsystemOwnIt) {
  EXPECT_EQ(rank_of({0, Role::kConfigure}, 1000), Rank::kOwner);
  EXPECT_EQ(rank_of({1000, Role::kConfigure}, 1000), Rank::kOwner);
  EXPECT_EQ(rank_of({1001, Role::kConfigure}, 1000), Rank::kConfigure);
  EXPECT_EQ(rank_of({1001, Role::kOperate}, 1000), Rank::kOperate);
  EXPECT_EQ(rank_of({1001, Role::kObserve}, 1000), Rank::kObserve);
}

TEST_F(PlacesTest, AreKeptForEveryHigherRank) {
  crowd(32, Rank::kObserve, Standing::kListens);
  EXPECT_EQ(refusal(1, Rank::kObserve), "the 32 of the role observe are all in use");
  crowd(8, Rank::kOperate, Standing::kListens);
  EXPECT_EQ(refusal(2, Rank::kConfigure), "");
  crowd(8, Rank::kConfigure, Standing::kListens);
  EXPECT_EQ(in_place_of(0, Rank::kOwner), 0u) << "sixteen are left for owners";
  sit(16, 0, Rank::kOwner, Standing::kActs);
  EXPECT_EQ(all.size(), kPlacesUpTo[4]);
}

TEST_F(PlacesTest, AnOwnerTakesThePlaceOfAnyConnectionThatDoesNotAct) {
  crowd(40, Rank::kOperate, Standing::kActs);
  crowd(8, Rank::kConfigure, Standing::kListens);
  sit(16, 1000, Rank::kOwner, Standing::kListens);
  EXPECT_EQ(in_place_of(0, Rank::kOwner), 41u);
  EXPECT_EQ(refusal(7, Rank::kOperate), "the 40 of the roles up to operate are all in use");
}

TEST_F(PlacesTest, GivesWayByRankThenHalfLineThenIdleTime) {
  sit(1, 1, Rank::kObserve, Standing::kAsks, seconds(1));
  sit(1, 2, Rank::kOperate, Standing::kHalfLine, seconds(1));
  sit(1, 3, Rank::kOperate, Standing::kIdle, seconds(1));
  sit(1, 4, Rank::kObserve, Standing::kIdle, seconds(3));
  sit(1, 5, Rank::kObserve, Standing::kIdle, seconds(2));
  sit(1, 6, Rank::kObserve, Standing::kHalfLine, seconds(9));
  sit(1, 7, Rank::kObserve, Standing::kHalfLine, seconds(8));
  crowd(57, Rank::kConfigure, Standing::kActs);
  for (const std::uint64_t expected : {7, 6, 5, 4, 2, 3, 1}) {
    const std::uint64_t first = in_place_of(0, Rank::kOwner);
    EXPECT_EQ(first, expected);
    for (Occupant& one : all)
      if (one.number == first) one = {0, 9, Rank::kConfigure, Standing::kActs, {}};
  }
  EXPECT_EQ(refusal(0, Rank::kOwner), "the 64 of all users are all in use");
}

TEST_F(PlacesTest, AConnectionNeverGivesWayToALowerRank) {
  crowd(10, Rank::kObserve, Standing::kListens);
  crowd(30, Rank::kOperate, Standing::kIdle);
  EXPECT_EQ(refusal(1, Rank::kObserve), "the 40 of the roles up to operate are all in use");
  EXPECT_EQ(in_place_of(2, Rank::kOperate), 11u) << "an idle connection of equal rank before a listener";
}

TEST_F(PlacesTest, ForANewConnectionOnlyOneOfTheSameUserGivesWay) {
  crowd(8, Rank::kObserve);
  sit(15, 1000, Rank::kOwner, Standing::kListens);
  sit(1, 1000, Rank::kOwner, Standing::kActs);
  EXPECT_EQ(refusal(1000, Rank::kOwner), "the 16 of user 1000 are all in use");
  all[10].standing = Standing::kAsks;
  EXPECT_EQ(in_place_of(1000, Rank::kOwner), 11u);
  EXPECT_EQ(in_place_of(0, Rank::kOwner), 0u);
}

}  // namespace
}  // namespace chimera::control
