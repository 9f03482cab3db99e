// SPDX-License-Identifier: Apache-2.0
#include "chimera/runtime/job/hang_rule.h"

#include <gtest/gtest.h>

#include <random>

namespace chimera {
namespace {

constexpr Nanoseconds kTick{1};

TaskSpec task_of(Nanoseconds period, Nanoseconds budget) {
  TaskSpec task;
  task.period = period;
  task.budget = budget;
  return task;
}

TEST(HangRule, KeepsAJobThatUsedTenTimesASmallBudget) {
  const TaskSpec fast = task_of(microseconds(500), microseconds(5));
  EXPECT_FALSE(hangs(fast, microseconds(130), {}));
  EXPECT_FALSE(hangs(fast, milliseconds(5), {}));
  EXPECT_TRUE(hangs(fast, milliseconds(5) + kTick, {}));
}

TEST(HangRule, CountsPeriodsOfATaskWithoutABudget) {
  const TaskSpec task = task_of(milliseconds(10), {});
  EXPECT_FALSE(hangs(task, milliseconds(100), {}));
  EXPECT_TRUE(hangs(task, milliseconds(100) + kTick, {}));
}

TEST(HangRule, GivesUpNoJobBeforeEveryBoundIsPassed) {
  std::mt19937_64 random(28);
  for (int i = 0; i < 10'000; ++i) {
    const Nanoseconds period{std::uniform_int_distribution<std::int64_t>(1'000, 1'000'000'000)(random)};
    const Nanoseconds budget{std::uniform_int_distribution<std::int64_t>(0, period.count)(random)};
    const Nanoseconds used{std::uniform_int_distribution<std::int64_t>(0, 12 * period.count)(random)};
    const TaskSpec task = task_of(period, budget);
    const bool is_beyond_all = used > (budget.count > 0 ? budget : period) * 10 && used > period * 3 &&
                               used > milliseconds(5);
    EXPECT_EQ(hangs(task, used, {}), is_beyond_all) << period.count << ' ' << budget.count << ' ' << used.count;
  }
}

TEST(HangRule, GivesUpAJobThatSleepsForTwoSecondsAndTenPeriods) {
  const TaskSpec fast = task_of(milliseconds(1), microseconds(10)), slow = task_of(seconds(1), microseconds(10));
  EXPECT_FALSE(hangs(fast, {}, seconds(2)));
  EXPECT_TRUE(hangs(fast, {}, seconds(2) + kTick));
  EXPECT_FALSE(hangs(slow, {}, seconds(10)));
  EXPECT_TRUE(hangs(slow, {}, seconds(10) + kTick));
}

}  // namespace
}  // namespace chimera
