// SPDX-License-Identifier: Apache-2.0
#include "bench/bench.h"

#include <gtest/gtest.h>

namespace chimera::bench {
namespace {

// Time is stepped: a candidate costs what it says.
struct SteppedTime {
  double now = 0;
  Comparison::Body costs(double ns) {
    return [this, ns](std::uint64_t n) { now += ns * static_cast<double>(n); };
  }
  Comparison::Clock clock() {
    return [this] { return now; };
  }
};

TEST(Quantile, InterpolatesBetweenNeighbours) {
  EXPECT_EQ(quantile({4, 1, 3, 2}, 0.5), 2.5);
  EXPECT_EQ(quantile({1, 2, 3}, 1.0), 3);
  EXPECT_EQ(quantile({}, 0.5), 0);
}

TEST(Comparison, FindsTheRatioOfTwoCosts) {
  SteppedTime time;
  Comparison comparison(11, time.clock());
  const auto fast = comparison.add("fast", time.costs(10));
  const auto slow = comparison.add("slow", time.costs(25));
  comparison.run(fast);
  EXPECT_DOUBLE_EQ(comparison.ratio(slow, fast), 2.5);
  EXPECT_DOUBLE_EQ(comparison.cost(slow), 25);
  EXPECT_DOUBLE_EQ(comparison.aa_spread(), 0);
}

TEST(Comparison, TheControlShowsANoisyMachine) {
  SteppedTime time;
  Comparison comparison(40, time.clock());
  std::uint64_t calls = 0;
  const auto only = comparison.add("noisy", [&](std::uint64_t n) {
    time.now += (++calls % 3 == 0 ? 20.0 : 10.0) * static_cast<double>(n);
  });
  comparison.run(only);
  EXPECT_GT(comparison.aa_spread(), 0.2);
}

TEST(Comparison, OneStallDoesNotChangeTheRatio) {
  SteppedTime time;
  Comparison comparison(21, time.clock());
  std::uint64_t calls = 0;
  const auto raw = comparison.add("raw", time.costs(10));
  const auto ours = comparison.add("ours", [&](std::uint64_t n) {
    time.now += 20.0 * static_cast<double>(n) + (++calls == 30 ? 60e6 : 0.0);
  });
  comparison.run(raw);
  EXPECT_DOUBLE_EQ(comparison.ratio(ours, raw), 2);
}

TEST(Comparison, PreparesEachTurnUnmeasuredAndKeepsToTheLimit) {
  SteppedTime time;
  Comparison comparison(11, time.clock());
  std::uint64_t room = 0, most = 0;
  const auto raw = comparison.add("raw", time.costs(10));
  const auto ring = comparison.add(
      "ring",
      [&](std::uint64_t n) {
        room -= std::min(room, n);
        most = std::max(most, n);
        time.costs(20)(n);
      },
      [&] { room = 64, time.now += 1e6; });
  comparison.limit(60);
  comparison.run(raw);
  EXPECT_EQ(most, 60u);
  EXPECT_EQ(room, 4u);
  EXPECT_DOUBLE_EQ(comparison.ratio(ring, raw), 2);
}

TEST(Figure, MeetsOrMissesItsGoal) {
  Figure figure{.row = 1, .what = "read", .figure = 15, .ratio = 1.5, .goal = ratio_at_most(1.5)};
  EXPECT_TRUE(figure.met());
  figure.ratio = 1.51;
  EXPECT_FALSE(figure.met());
  figure.goal = figure_at_least(15);
  EXPECT_TRUE(figure.met());
  figure.goal = figure_at_least(16);
  EXPECT_FALSE(figure.met());
}

TEST(Figure, IsNotMetWithoutANumber) {
  EXPECT_FALSE((Figure{.goal = ratio_at_most(2)}.met()));
  EXPECT_FALSE((Figure{.goal = figure_at_least(2)}.met()));
}

TEST(Figure, IsOneLineOfJson) {
  const Figure figure{.row = 4, .what = "read \"80 B\"", .figure = 5, .baseline = 2.5, .baseline_name = "memcpy",
                      .ratio = 2, .goal = ratio_at_most(1.5), .aa_spread = 0.01, .n = 100};
  EXPECT_EQ(figure.json(),
            "{\"row\": 4, \"what\": \"read \\\"80 B\\\"\", \"figure\": 5, \"unit\": \"ns\", \"baseline\": 2.5, "
            "\"baseline_name\": \"memcpy\", \"limit\": null, \"ratio\": 2, \"goal\": \"ratio <= 1.5\", "
            "\"met\": false, \"aa_spread\": 0.01, \"n\": 100}");
}

}  // namespace
}  // namespace chimera::bench
