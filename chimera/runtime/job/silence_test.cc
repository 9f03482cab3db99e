// SPDX-License-Identifier: Apache-2.0
#include "chimera/runtime/job/silence.h"

#include <gtest/gtest.h>

namespace chimera {
namespace {

struct SilenceTest : ::testing::Test {
  /// A look in time; true: too silent.
  bool look(bool is_on, std::uint64_t published) {
    now = silence.due() == Nanoseconds{} ? milliseconds(100) : silence.due();
    return silence.look(is_on, published, now);
  }
  Silence silence{TaskId(std::size_t{0}), milliseconds(10), 3};
  Nanoseconds now;
};

TEST_F(SilenceTest, CountsPeriodsInARowWithoutAPublication) {
  EXPECT_FALSE(look(true, 5));
  for (int round = 0; round < 2; ++round) {
    EXPECT_FALSE(look(true, 5));
    EXPECT_FALSE(look(true, 5));
    EXPECT_FALSE(look(true, 6)) << "it has spoken";
    EXPECT_FALSE(look(true, 5)) << "another number is news, whichever";
  }
  EXPECT_FALSE(look(true, 5));
  EXPECT_FALSE(look(true, 5));
  EXPECT_TRUE(look(true, 5));
  EXPECT_FALSE(look(true, 5)) << "begins anew";
}

TEST_F(SilenceTest, ATaskThatIsNotOnMayBeSilent) {
  for (int i = 0; i < 10; ++i) EXPECT_FALSE(look(false, 5));
  EXPECT_FALSE(look(true, 5)) << "the first look of a task that is ON";
  EXPECT_FALSE(look(true, 5));
  EXPECT_FALSE(look(true, 5));
  EXPECT_TRUE(look(true, 5));
}

TEST_F(SilenceTest, ALateCheckDoesNotCount) {
  EXPECT_FALSE(look(true, 5));
  for (int i = 0; i < 10; ++i) {
    now = silence.due() + milliseconds(6);
    EXPECT_FALSE(silence.look(true, 5, now));
    EXPECT_EQ(silence.due(), now + milliseconds(10));
  }
  for (int i = 0; i < 2; ++i) {
    now = silence.due() + milliseconds(4);
    EXPECT_FALSE(silence.look(true, 5, now)) << "within half a period";
  }
  now = silence.due();
  EXPECT_TRUE(silence.look(true, 5, now));
}

TEST_F(SilenceTest, IsReachedWhenTheOutputsOfThePrimaryAreTooOld) {
  for (const auto& [after_ms, periods] : {std::pair{20, 2}, std::pair{21, 3}, std::pair{30, 3}}) {
    const StandbySpec standby{TaskId(std::size_t{4}), TaskId(std::size_t{5}), milliseconds(after_ms)};
    Silence made = Silence::of(standby, milliseconds(10));
    EXPECT_EQ(made.task(), TaskId(std::size_t{4}));
    EXPECT_EQ(made.standby(), TaskId(std::size_t{5}));
    EXPECT_FALSE(made.look(true, 1, made.due()));
    for (int i = 1; i < periods; ++i) EXPECT_FALSE(made.look(true, 1, made.due()));
    EXPECT_TRUE(made.look(true, 1, made.due())) << after_ms;
  }
}

}  // namespace
}  // namespace chimera
