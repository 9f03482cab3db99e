// SPDX-License-Identifier: Apache-2.0
#include "chimera/schedule/data_age.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>
#include <vector>

namespace chimera::data_age_test {
namespace {

Work work(std::int64_t period, std::int64_t time, std::int64_t offset = 0) {
  return {.period = milliseconds(period), .deadline = milliseconds(period), .offset = milliseconds(offset),
          .time = milliseconds(time), .criticality = 0, .user_priority = 0, .rtpu = 0, .server = {}};
}

TEST(DataAge, AddsPeriodAndResponseOfEachLink) {
  const std::vector<ChainLink> chain = {{work(10, 1), milliseconds(3), false}, {work(20, 2), milliseconds(7), false}};
  EXPECT_EQ(worst_data_age(chain), milliseconds(10 + 3 + 20 + 7));
}

TEST(DataAge, TakesLessWhereTheProducerAlwaysGoesFirst) {
  std::vector<ChainLink> chain = {{work(10, 1), milliseconds(3), true}, {work(20, 2), milliseconds(7), false}};
  EXPECT_EQ(worst_data_age(chain), milliseconds(27));  // each release of the second is one of the first
  chain[1].work = work(20, 2, 5);
  EXPECT_EQ(worst_data_age(chain), milliseconds(37));
  chain[1].work = work(15, 2);
  EXPECT_EQ(worst_data_age(chain), milliseconds(32));
}

TEST(DataAge, HasNoBoundWhereATaskHasNone) {
  EXPECT_EQ(worst_data_age(std::vector<ChainLink>{{work(10, 1), kNever, false}}), kNever);
}

TEST(DataAge, KnowsTheTaskThatAlwaysGoesFirst) {
  const Work a = work(10, 1), b = work(20, 1);
  for (const Policy policy : {Policy::kRm, Policy::kEdf, Policy::kMuf}) {
    const ProcessorUse use{.policy = policy};
    EXPECT_TRUE(goes_always_before(a, 5, b, 4, use));
    EXPECT_FALSE(goes_always_before(b, 4, a, 5, use));
    EXPECT_TRUE(goes_always_before(a, 4, a, 5, use)) << "equals without a place";
    EXPECT_FALSE(goes_always_before(a, 5, a, 4, use));
    Work behind = a;
    behind.place = 1;
    EXPECT_FALSE(goes_always_before(behind, 4, a, 5, use)) << "its place is behind";
    EXPECT_TRUE(goes_always_before(a, 5, behind, 4, use));
    EXPECT_FALSE(goes_always_before(a, 4, work(10, 1, 1), 5, use));
  }
  EXPECT_FALSE(goes_always_before(a, 0, b, 1, {.policy = Policy::kLlf}));
  Work other = b;
  other.rtpu = 1;
  EXPECT_FALSE(goes_always_before(a, 0, other, 1, {.policy = Policy::kRm}));
}

// Simulates three tasks on three processors at random: no actuator uses data older than the bound.
TEST(DataAge, BoundsTheAgesOfRandomRuns) {
  std::mt19937 random(7);
  for (int run = 0; run < 300; ++run) {
    std::int64_t period[3], response[3], offset[3];
    std::vector<ChainLink> chain;
    for (int i = 0; i < 3; ++i) {
      period[i] = 2 + static_cast<std::int64_t>(random() % 20);
      response[i] = 1 + static_cast<std::int64_t>(random() % static_cast<unsigned>(period[i]));
      offset[i] = static_cast<std::int64_t>(random() % static_cast<unsigned>(period[i]));
      chain.push_back({work(period[i], 1), milliseconds(response[i]), false});
    }
    // published[i]: (end, release of the sensor job at its origin) of each job of task i.
    std::vector<std::pair<std::int64_t, std::int64_t>> published[3];
    std::int64_t oldest = 0;
    for (int i = 0; i < 3; ++i)
      for (std::int64_t release = offset[i]; release < 400; release += period[i]) {
        const std::int64_t end = release + 1 + static_cast<std::int64_t>(random() % static_cast<unsigned>(response[i]));
        std::int64_t origin = i == 0 ? release : -1;
        for (const auto& [at, from] : i == 0 ? published[0] : published[i - 1])
          if (i > 0 && at <= release) origin = std::max(origin, from);
        // The previous output was replaced at `end`.
        if (i == 2 && !published[2].empty() && published[2].back().second >= 0)
          oldest = std::max(oldest, end - published[2].back().second);
        published[i].emplace_back(end, origin);
      }
    ASSERT_LE(milliseconds(oldest), worst_data_age(chain)) << "run " << run;
  }
}

}  // namespace
}  // namespace chimera::data_age_test
