// SPDX-License-Identifier: Apache-2.0
#include "chimera/schedule/recent_use.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>
#include <vector>

namespace chimera {
namespace {

constexpr Nanoseconds kBegin = seconds(1000);

TEST(RecentUse, NothingIsInUseBeforeItIsSaid) {
  RecentUse use(seconds(1));
  EXPECT_EQ(use.used(kBegin), Nanoseconds{});
  use.set(false, kBegin + seconds(5));
  EXPECT_EQ(use.used(kBegin + seconds(6)), Nanoseconds{});
}

TEST(RecentUse, CountsUseWithinTheWindowOnly) {
  RecentUse use(seconds(1));
  use.set(true, kBegin);
  EXPECT_EQ(use.used(kBegin + milliseconds(300)), milliseconds(300));
  use.set(false, kBegin + milliseconds(400));
  EXPECT_EQ(use.used(kBegin + milliseconds(900)), milliseconds(400));
  EXPECT_EQ(use.used(kBegin + milliseconds(1100)), milliseconds(300));
  EXPECT_EQ(use.used(kBegin + milliseconds(1395)), milliseconds(5));
  EXPECT_EQ(use.used(kBegin + milliseconds(1500)), Nanoseconds{});
}

TEST(RecentUse, NeverCountsMoreThanTheWindow) {
  RecentUse use(milliseconds(100));
  use.set(true, kBegin);
  for (int ms = 0; ms < 500; ++ms)
    EXPECT_EQ(use.used(kBegin + milliseconds(ms)), milliseconds(std::min(ms, 100))) << ms;
  EXPECT_EQ(use.used(kBegin + seconds(3600)), milliseconds(100)) << "an hour without a call";
}

TEST(RecentUse, AGapLongerThanTheWindowLeavesNothing) {
  RecentUse use(milliseconds(100));
  use.set(true, kBegin);
  use.set(false, kBegin + milliseconds(50));
  EXPECT_EQ(use.used(kBegin + seconds(3600)), Nanoseconds{});
  use.set(true, kBegin + seconds(3600));
  EXPECT_EQ(use.used(kBegin + seconds(3600) + milliseconds(7)), milliseconds(7));
}

// Compares with the sum of the intervals: the error is at most one bin.
TEST(RecentUse, AgreesWithTheSumOfTheIntervals) {
  constexpr Nanoseconds kWindow = milliseconds(100);
  std::mt19937_64 random(7);
  for (int round = 0; round < 50; ++round) {
    RecentUse use(kWindow);
    std::vector<std::pair<Nanoseconds, Nanoseconds>> intervals;
    const std::int64_t longest = std::int64_t{1} << (10 + random() % 16);  // 1 us to 33 ms
    Nanoseconds now = kBegin;
    const auto some = [&] { return Nanoseconds{static_cast<std::int64_t>(random()) & (longest - 1)}; };
    for (int i = 0; i < 400; ++i) {
      const Nanoseconds begin = now + some(), end = begin + some();
      use.set(true, begin);
      use.set(false, end);
      intervals.emplace_back(begin, end);
      now = end + Nanoseconds{static_cast<std::int64_t>(random() % 1000)};
      Nanoseconds truth;
      for (const auto& [from, to] : intervals) truth += std::max(Nanoseconds{}, to - std::max(from, now - kWindow));
      EXPECT_NEAR(static_cast<double>(use.used(now).count), static_cast<double>(truth.count), 1e6 + 1);
    }
  }
}

}  // namespace
}  // namespace chimera
