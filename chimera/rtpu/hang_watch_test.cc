// SPDX-License-Identifier: Apache-2.0
#include "chimera/rtpu/hang_watch.h"

#include <gtest/gtest.h>

#include "chimera/runtime/task_word.h"

namespace chimera {
namespace {

constexpr std::uint32_t kCycleOfFirst = TaskWord(TaskId(0u), Method::kCycle).word(),
                        kOffOfFirst = TaskWord(TaskId(0u), Method::kOff).word();

struct HangWatchTest : ::testing::Test {
  HangWatch watch{milliseconds(500)};
  Nanoseconds now = seconds(1000);
};

TEST_F(HangWatchTest, ALoopThatStaysInOneMethodForLongerThanTheLimitHangs) {
  EXPECT_FALSE(watch.loop_hangs(kCycleOfFirst, 7, now));
  EXPECT_FALSE(watch.loop_hangs(kCycleOfFirst, 7, now + milliseconds(500)));
  EXPECT_TRUE(watch.loop_hangs(kCycleOfFirst, 7, now + milliseconds(500) + Nanoseconds{1}));
}

TEST_F(HangWatchTest, ALoopThatWaitsDoesNotHangHoweverLong) {
  EXPECT_FALSE(watch.loop_hangs(0, 7, now));
  EXPECT_FALSE(watch.loop_hangs(0, 7, now + seconds(60)));
  EXPECT_FALSE(watch.loop_hangs(kCycleOfFirst, 7, now + seconds(120)));  // in it for 50 ms at most
}

TEST_F(HangWatchTest, AJobThatEndsOrAnotherMethodBeginsTheLimitAnew) {
  EXPECT_FALSE(watch.loop_hangs(kCycleOfFirst, 7, now));
  EXPECT_FALSE(watch.loop_hangs(kCycleOfFirst, 8, now + milliseconds(600)));
  EXPECT_FALSE(watch.loop_hangs(kOffOfFirst, 8, now + milliseconds(1200)));
  EXPECT_FALSE(watch.loop_hangs(kOffOfFirst, 8, now + milliseconds(1700)));
  EXPECT_TRUE(watch.loop_hangs(kOffOfFirst, 8, now + milliseconds(1701)));
}

TEST_F(HangWatchTest, AJobHangsByWhatItUsesAndNotByTheTimeThatOthersTake) {
  TaskSpec task;
  task.period = milliseconds(1);
  task.budget = microseconds(5);
  Nanoseconds used = seconds(7);  // by all jobs of the loop until now
  EXPECT_FALSE(watch.job_hangs(task, kCycleOfFirst, 7, used, now));
  EXPECT_FALSE(watch.job_hangs(task, kCycleOfFirst, 7, used + milliseconds(5), now + milliseconds(1900)));
  EXPECT_EQ(watch.job_used(), Nanoseconds{});
  EXPECT_TRUE(watch.job_hangs(task, kCycleOfFirst, 7, used + milliseconds(6), now + milliseconds(1900)));
  EXPECT_EQ(watch.job_used(), milliseconds(6));
  used += milliseconds(6);
  EXPECT_FALSE(watch.job_hangs(task, kCycleOfFirst, 8, used, now + milliseconds(2000))) << "the next job";
  EXPECT_FALSE(watch.job_hangs(task, kCycleOfFirst, 8, used, now + milliseconds(4000)));
  EXPECT_TRUE(watch.job_hangs(task, kCycleOfFirst, 8, used, now + milliseconds(4001))) << "it sleeps";
  EXPECT_EQ(watch.job_used(), Nanoseconds{});
}

TEST_F(HangWatchTest, OneMethodOfAnEdgeMayTakeTheLimit) {
  EXPECT_FALSE(watch.method_hangs(kOffOfFirst, 1, now));
  EXPECT_FALSE(watch.method_hangs(kOffOfFirst, 1, now + milliseconds(500)));
  EXPECT_FALSE(watch.method_hangs(kOffOfFirst, 3, now + milliseconds(501))) << "another call of it";
  EXPECT_FALSE(watch.method_hangs(0, 4, now + seconds(60)));
  EXPECT_FALSE(watch.method_hangs(kOffOfFirst, 5, now + seconds(61)));
  EXPECT_TRUE(watch.method_hangs(kOffOfFirst, 5, now + seconds(61) + milliseconds(501)));
}

TEST_F(HangWatchTest, AnEndInWhichNothingGetsDoneHangsAfterTwoLimitsAndAMargin) {
  watch.begin_end(now);
  EXPECT_FALSE(watch.end_hangs(0, now + milliseconds(1100)));
  EXPECT_TRUE(watch.end_hangs(0, now + milliseconds(1101)));
}

TEST_F(HangWatchTest, EachMethodOfTheEndHasItsOwnTime) {
  watch.begin_end(now);
  EXPECT_FALSE(watch.end_hangs(1, now + milliseconds(1100)));
  EXPECT_FALSE(watch.end_hangs(2, now + milliseconds(2200)));
  EXPECT_FALSE(watch.end_hangs(2, now + milliseconds(3300)));
  EXPECT_TRUE(watch.end_hangs(2, now + milliseconds(3301)));
}

}  // namespace
}  // namespace chimera
