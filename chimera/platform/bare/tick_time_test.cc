// SPDX-License-Identifier: Apache-2.0
#include "chimera/platform/bare/tick_time.h"

#include <gtest/gtest.h>

namespace chimera::bare::tick_time_test {

TEST(TickTime, IsExactToTheCycle) {
  const TickTime time(25'000'000, milliseconds(1));
  ASSERT_EQ(time.cycles(), 25'000u);
  for (std::uint32_t gone = 1; gone <= time.cycles(); ++gone)
    ASSERT_EQ(time.at(7, time.cycles() - gone, false), milliseconds(7) + Nanoseconds{gone * 40}) << gone;
}

TEST(TickTime, RoundsDownIfACycleIsNoWholeNumberOfNanoseconds) {
  const TickTime time(24'000'000, milliseconds(1));
  for (std::uint32_t gone = 1; gone <= time.cycles(); ++gone)
    ASSERT_EQ(time.at(0, time.cycles() - gone, false), (Nanoseconds{gone * std::int64_t{125} / 3})) << gone;
}

TEST(TickTime, CountsAWaitingTickIfTheCounterHasStartedAgain) {
  const TickTime time(25'000'000, milliseconds(1));
  EXPECT_EQ(time.at(3, 24'999, true), milliseconds(4) + Nanoseconds{40});
  EXPECT_EQ(time.at(3, 24'999, false), milliseconds(3) + Nanoseconds{40});
}

TEST(TickTime, CountsNoWaitingTickIfTheCounterWasReadBeforeIt) {
  const TickTime time(25'000'000, milliseconds(1));
  EXPECT_EQ(time.at(3, 1, true), milliseconds(4) - Nanoseconds{40});
  EXPECT_EQ(time.at(3, 0, true), milliseconds(4));
}

}  // namespace chimera::bare::tick_time_test
