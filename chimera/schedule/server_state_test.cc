// SPDX-License-Identifier: Apache-2.0
#include "chimera/schedule/server_state.h"

#include <gtest/gtest.h>

#include <random>
#include <vector>

namespace chimera {
namespace {

constexpr Nanoseconds ms(std::int64_t n) { return milliseconds(n); }

// Buttazzo, Hard Real-Time Computing Systems, 5.5, the medium-priority sporadic server: capacity 5, period 10. Requests
// of 2 at 4 (preempted from 5 to 6) and of 2 at 8: 2 come back at 14 and 2 at 18.
TEST(ServerState, TheTextbooksSporadicServerOfMediumPriority) {
  ServerState server({ServerKind::kSporadic, ms(5), ms(10)}, {});
  server.activate(ms(4));
  EXPECT_EQ(server.allowance(ms(4)), ms(5));
  EXPECT_EQ(server.deadline(), ms(14));
  server.charge(ms(1));
  server.charge(ms(1));
  server.activate(ms(8));
  EXPECT_EQ(server.allowance(ms(8)), ms(3));
  EXPECT_EQ(server.deadline(), ms(18));
  server.charge(ms(2));
  server.activate(ms(13));
  EXPECT_EQ(server.allowance(ms(13)), ms(1));
  server.charge(ms(1));
  EXPECT_EQ(server.allowance(ms(13)), Nanoseconds{});
  EXPECT_EQ(server.next_change(ms(13)), ms(14));
  EXPECT_EQ(server.allowance(ms(14)), ms(2));  // of the request at 4..7
  server.charge(ms(2));
  EXPECT_EQ(server.next_change(ms(16)), ms(18));
  EXPECT_EQ(server.allowance(ms(18)), ms(2));  // of the request at 8..10
  EXPECT_EQ(server.deadline(), ms(28));
}

// The same section, the server of the highest priority: capacity 2, period 8. A request of 2 at 2 uses it all: 2 come
// back at 10. The next request waits for that, and then counts from 10: 2 come back at 18.
TEST(ServerState, TheTextbooksSporadicServerOfTheHighestPriority) {
  ServerState server({ServerKind::kSporadic, ms(2), ms(8)}, {});
  server.activate(ms(2));
  server.charge(ms(2));
  server.activate(ms(6));
  EXPECT_EQ(server.allowance(ms(6)), Nanoseconds{});
  EXPECT_EQ(server.next_change(ms(6)), ms(10));
  EXPECT_EQ(server.allowance(ms(10)), ms(2));
  EXPECT_EQ(server.deadline(), ms(18));
  server.charge(ms(2));
  EXPECT_EQ(server.next_change(ms(12)), ms(18));
}

// The same book, 5.3: capacity 2, period 5. Unused capacity stays until the end of the period, and no longer.
TEST(ServerState, TheTextbooksDeferrableServer) {
  ServerState server({ServerKind::kDeferrable, ms(2), ms(5)}, {});
  server.activate(ms(2));
  EXPECT_EQ(server.deadline(), ms(5));
  server.charge(ms(2));
  EXPECT_EQ(server.allowance(ms(4)), Nanoseconds{});
  EXPECT_EQ(server.next_change(ms(4)), ms(5));
  server.activate(ms(8));
  EXPECT_EQ(server.allowance(ms(8)), ms(2));
  server.charge(ms(1));
  server.follow(ms(10));
  EXPECT_EQ(server.allowance(ms(10)), ms(2));
  EXPECT_EQ(server.deadline(), ms(15));
}

TEST(ServerState, ADeferrableServerMayRunTwiceBackToBack) {
  ServerState server({ServerKind::kDeferrable, ms(2), ms(5)}, {});
  server.activate(ms(3));
  server.charge(ms(2));
  server.follow(ms(5));
  EXPECT_EQ(server.allowance(ms(5)), ms(2));
}

TEST(ServerState, CapacityThatComesBackWhileTheServerIsActiveCountsFromThen) {
  ServerState server({ServerKind::kSporadic, ms(4), ms(10)}, {});
  server.activate({});
  server.charge(ms(1));         // back at 10
  server.activate(ms(8));       // 3 are left; busy from here on
  server.charge(ms(3));         // back at 18, begun at 8 and ended at 12
  EXPECT_EQ(server.allowance(ms(12)), ms(1));
  EXPECT_EQ(server.deadline(), ms(20));
  server.charge(ms(1));
  EXPECT_EQ(server.next_change(ms(13)), ms(18));
}

TEST(ServerState, TimeBeyondTheAllowanceIsTakenFromTheNextCapacity) {
  ServerState deferrable({ServerKind::kDeferrable, ms(2), ms(5)}, {});
  deferrable.activate({});
  deferrable.charge(ms(3));
  EXPECT_EQ(deferrable.allowance(ms(3)), Nanoseconds{});
  deferrable.follow(ms(5));
  EXPECT_EQ(deferrable.allowance(ms(5)), ms(1));
  ServerState sporadic({ServerKind::kSporadic, ms(2), ms(5)}, {});
  sporadic.activate({});
  sporadic.charge(ms(3));
  EXPECT_EQ(sporadic.next_change(ms(3)), ms(5));
  EXPECT_EQ(sporadic.allowance(ms(5)), ms(1));
  EXPECT_EQ(sporadic.total(), ms(2));
}

// The use of a server, per millisecond, if no other job delays it.
std::vector<int> use_at_random(const ServerSpec& spec, std::mt19937& random, int length) {
  ServerState server(spec, {});
  std::vector<int> used(static_cast<std::size_t>(length), 0);
  int wanted = 0;
  for (int t = 0; t < length; ++t) {
    if (random() % 4 == 0) {
      if (wanted == 0) server.activate(ms(t));
      wanted += 1 + static_cast<int>(random() % 5);
    }
    if (wanted == 0) continue;
    server.follow(ms(t));
    if (server.allowance(ms(t)) == Nanoseconds{}) {
      EXPECT_GT(server.next_change(ms(t)), ms(t));
      continue;
    }
    server.charge(ms(1));
    EXPECT_TRUE(spec.kind == ServerKind::kDeferrable || server.total() == spec.capacity);
    used[static_cast<std::size_t>(t)] = 1;
    --wanted;
  }
  return used;
}

int most_in_any_window(const std::vector<int>& used, std::size_t window, std::size_t step) {
  int most = 0;
  for (std::size_t from = 0; from + window <= used.size(); from += step) {
    int sum = 0;
    for (std::size_t i = 0; i < window; ++i) sum += used[from + i];
    most = std::max(most, sum);
  }
  return most;
}

TEST(ServerState, NoWindowSeesMoreThanTheKindOfServerAllows) {
  std::mt19937 random(7);
  bool came_near = false;
  for (int i = 0; i < 300; ++i) {
    const auto period = static_cast<std::int64_t>(2 + random() % 60);
    const auto capacity = 1 + static_cast<std::int64_t>(random()) % period;
    const auto window = static_cast<std::size_t>(period);
    const auto sporadic = use_at_random({ServerKind::kSporadic, ms(capacity), ms(period)}, random, 1000);
    EXPECT_LE(most_in_any_window(sporadic, window, 1), capacity);
    const auto deferrable = use_at_random({ServerKind::kDeferrable, ms(capacity), ms(period)}, random, 1000);
    EXPECT_LE(most_in_any_window(deferrable, window, window), capacity);
    came_near = came_near || most_in_any_window(deferrable, window, 1) > capacity;  // two capacities back to back
  }
  EXPECT_TRUE(came_near);
}

TEST(ServerState, MorePiecesThanAreKeptComeBackTogetherAndLate) {
  ServerState server({ServerKind::kSporadic, ms(40), ms(100)}, {});
  for (int i = 0; i < 40; ++i) {
    server.activate(ms(2 * i));
    ASSERT_EQ(server.allowance(ms(2 * i)), ms(40 - i));
    server.charge(ms(1));
    EXPECT_EQ(server.total(), ms(40));
  }
  EXPECT_EQ(server.next_change(ms(79)), ms(100));
  server.activate(ms(175));
  EXPECT_EQ(server.allowance(ms(175)), ms(14));  // charged before 28; the next 25 were merged
  server.activate(ms(176));
  EXPECT_EQ(server.allowance(ms(176)), ms(39));
  server.activate(ms(178));
  EXPECT_EQ(server.allowance(ms(178)), ms(40));
}

}  // namespace
}  // namespace chimera
