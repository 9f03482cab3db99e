// SPDX-License-Identifier: Apache-2.0
#include "chimera/platform/cycle_counter.h"

#include <gtest/gtest.h>

#include <string_view>

#include "chimera/platform/clock.h"

namespace chimera {
namespace {

constexpr std::uint64_t kHalfNsPerTick = std::uint64_t{1} << 31;  // a counter of 2 GHz

TEST(TickScale, ConvertsTicksByItsRate) {
  const TickScale scale(1000, Nanoseconds{50}, kHalfNsPerTick);
  EXPECT_EQ(scale.at(1000).count, 50);
  EXPECT_EQ(scale.at(1002).count, 51);
  EXPECT_EQ(scale.at(1000 + 2'000'000'000ull * 86'400).count, 50 + 86'400'000'000'000);  // a day
}

TEST(TickScale, TickBeforeTheComparisonGivesTheTimeOfTheComparison) {
  const TickScale scale(1000, Nanoseconds{50}, kHalfNsPerTick);
  EXPECT_EQ(scale.at(990).count, 50);
}

TEST(TickScale, JumpsForwardWhenBehindTheReference) {
  TickScale scale(0, Nanoseconds{0}, kHalfNsPerTick);
  scale.compare(2000, Nanoseconds{1500});
  EXPECT_EQ(scale.at(2000).count, 1500);
  EXPECT_EQ(scale.at(4000).count, 2500);
}

TEST(TickScale, RunsSlowerAndNeverBackWhenAheadOfTheReference) {
  TickScale scale(0, Nanoseconds{0}, kHalfNsPerTick);
  scale.compare(2'000'000, Nanoseconds{999'000});  // 1 us ahead after 1 ms
  EXPECT_EQ(scale.at(2'000'000).count, 1'000'000);
  EXPECT_EQ(scale.at(4'048'000).count, 1'000'000 + 1'024'000 - 1'000);  // 1.024 ms later: level again
  scale.compare(4'048'000, Nanoseconds{2'023'000});
  EXPECT_EQ(scale.at(4'050'000).count, 2'024'000);
}

// A machine that stalls while counter and clock are read spoils one comparison, not five hundred.
TEST(CycleCounter, StaysWithTheMonotonicClock) {
  LinuxClock clock;
  CycleCounter counter = CycleCounter::calibrate();
  int good = 0;
  for (int i = 0; i < 500 && good < 20; ++i) {
    clock.wait_until(clock.now() + microseconds(200));
    counter.compare();
    const Nanoseconds before = clock.now(), between = counter.now(), after = clock.now();
    if (between >= before - microseconds(5) && between <= after + microseconds(5)) ++good;
  }
  EXPECT_EQ(good, 20);
}

TEST(CycleCounter, NeverGoesBack) {
  CycleCounter counter = CycleCounter::calibrate();
  Nanoseconds last = counter.now();
  for (int i = 0; i < 20'000; ++i) {
    if (i % 100 == 0) counter.compare();
    const Nanoseconds now = counter.now();
    ASSERT_GE(now, last);
    last = now;
  }
}

TEST(CycleCounter, SaysWhichClockItReads) {
  const CycleCounter counter = CycleCounter::calibrate();
  const std::string_view text = counter.describe();
  if (text.starts_with("cycle counter at "))
    EXPECT_TRUE(text.ends_with(" MHz")) << text;
  else
    EXPECT_TRUE(text.starts_with("clock_gettime (")) << text;
}

}  // namespace
}  // namespace chimera
