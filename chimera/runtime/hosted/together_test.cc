// SPDX-License-Identifier: Apache-2.0
#include "chimera/runtime/hosted/together.h"

#include <gtest/gtest.h>

#include <array>

namespace chimera::together_test {

constexpr TaskId kPid{0u}, kHot{1u}, kCold{2u}, kMotor{3u};
constexpr std::array<StandbySpec, 2> kStandbys{{{kPid, kHot, {}, true}, {kPid, kCold, {}, false}}};

TEST(Together, ListsTheSetAndEachTakeoverWithHotStandbys) {
  const auto all = all_together(kStandbys, std::array{kPid, kMotor});
  ASSERT_EQ(all.size(), 3u);
  EXPECT_FALSE(all[0].is_takeover());
  EXPECT_EQ(all[0].tasks, (std::vector{kPid, kMotor, kHot}));
  EXPECT_EQ(all[1].standby, kHot);
  EXPECT_EQ(all[1].tasks, (std::vector{kHot, kMotor}));
  EXPECT_EQ(all[2].standby, kCold);
  EXPECT_EQ(all[2].primary, kPid);
  EXPECT_EQ(all[2].tasks, (std::vector{kCold, kMotor, kHot}));
}

TEST(Together, ListsNoTakeoverWithoutThePrimary) {
  const auto without = all_together(kStandbys, std::array{kMotor});
  ASSERT_EQ(without.size(), 1u);
  EXPECT_EQ(without[0].tasks, (std::vector{kMotor}));
  const auto taken_over = all_together(kStandbys, std::array{kCold});
  ASSERT_EQ(taken_over.size(), 1u);
  EXPECT_EQ(taken_over[0].tasks, (std::vector{kCold, kHot}));
}

}  // namespace chimera::together_test
