// SPDX-License-Identifier: Apache-2.0
#include "chimera/runtime/preemptive/job_checks.h"

#include <gtest/gtest.h>

#include "chimera/platform/clock.h"
#include "chimera/runtime/testing/ended_thread.h"

namespace chimera {
namespace {

// In an hour: the alarm is set, and does not ring while the test runs.
const Nanoseconds kNow = LinuxClock().now() + seconds(3600);
constexpr Nanoseconds kShortest = milliseconds(5), kWindow = JobChecks::kCoalesceWindow;

struct ThreeTasks {
  ThreeTasks() {
    for (std::uint32_t i = 0; i < 3; ++i) {
      specs_[i].period = milliseconds(10);
      tasks_[i].spec = &specs_[i];
      tasks_[i].id = TaskId(i);
    }
    specs_[2].budget = milliseconds(2);
    specs_[2].on_overrun = OnMiss::kDemote;
  }

  TaskSpec specs_[3];
  Task tasks_[3];
};

struct JobChecksTest : ThreeTasks, ::testing::Test {
  JobThread plain_{tasks_[0]}, other_{tasks_[1]}, exact_{tasks_[2]};
  JobChecks checks_{3, kShortest};
};

TEST_F(JobChecksTest, ChecksAJobThatIsAloneALittleLate) {
  checks_.watch(plain_, kNow + milliseconds(10), 1);
  EXPECT_EQ(checks_.due(plain_), kNow + milliseconds(10));
  EXPECT_EQ(checks_.armed(), kNow + milliseconds(10) + kWindow);
}

TEST_F(JobChecksTest, ChecksInTimeWhenAReactionActsAtTheEndOfTheBudget) {
  checks_.watch(exact_, kNow + milliseconds(2), 1);
  EXPECT_EQ(checks_.armed(), kNow + milliseconds(2));
}

TEST_F(JobChecksTest, ChecksInTimeWhenOthersAreReady) {
  checks_.watch(plain_, kNow + milliseconds(10), 1);
  checks_.watch(other_, kNow + milliseconds(20), 2);
  EXPECT_EQ(checks_.armed(), kNow + milliseconds(10)) << "the first one is not alone any more";
}

TEST_F(JobChecksTest, LeavesAnAlarmThatComesSoonerWhereItIs) {
  checks_.watch(exact_, kNow + milliseconds(2), 1);
  checks_.watch(plain_, kNow + milliseconds(10), 2);
  EXPECT_EQ(checks_.armed(), kNow + milliseconds(2));
  checks_.arm_by(kNow + milliseconds(3));
  EXPECT_EQ(checks_.armed(), kNow + milliseconds(2));
  checks_.arm_by(kNow + milliseconds(1));
  EXPECT_EQ(checks_.armed(), kNow + milliseconds(1));
}

TEST_F(JobChecksTest, PutsTheAlarmOffWhenNoJobIsReady) {
  checks_.watch(plain_, kNow + milliseconds(1), 1);
  checks_.clear(plain_);
  checks_.put_off(kNow);
  EXPECT_EQ(checks_.armed(), kNow + kShortest + kWindow) << "no job can be late before";
}

TEST_F(JobChecksTest, PutsItOffOnlyToTheCheckOfAJobThatWasDemoted) {
  checks_.watch(plain_, kNow + milliseconds(1), 1);
  checks_.clear(plain_);
  checks_.set(other_, kNow + milliseconds(4));
  checks_.put_off(kNow);
  EXPECT_EQ(checks_.armed(), kNow + milliseconds(4));
}

TEST_F(JobChecksTest, DoesNotMoveAnAlarmThatIsFarEnoughAway) {
  const Nanoseconds far = kNow + kShortest + JobChecks::kPutOffMargin + Nanoseconds{1};
  checks_.rearm(far);
  checks_.put_off(kNow);
  EXPECT_EQ(checks_.armed(), far);
}

TEST_F(JobChecksTest, NeverPutsOffToAnEarlierInstant) {
  checks_.rearm(kNow + milliseconds(3));
  checks_.set(other_, kNow + milliseconds(2));
  checks_.put_off(kNow);
  EXPECT_EQ(checks_.armed(), kNow + milliseconds(3));
}

TEST_F(JobChecksTest, ForgetsCoalescedChecksWhenTheAlarmIsSetAnew) {
  checks_.watch(plain_, kNow + milliseconds(10), 1);
  checks_.rearm(kNever);
  checks_.watch(other_, kNow + milliseconds(20), 2);
  EXPECT_EQ(checks_.armed(), kNow + milliseconds(20));
}

TEST_F(JobChecksTest, LooksLessOftenAtAJobThatComputesNothing) {
  exact_.start([this] { exact_.attach(); });
  testing::join_and_await_end(exact_);  // the job has used nothing, now and at the next look
  const Nanoseconds first = checks_.end_of_budget(exact_, false, kNow);
  EXPECT_EQ(first, kNow + milliseconds(2));
  specs_[2].budget = microseconds(1);
  EXPECT_EQ(checks_.end_of_budget(exact_, false, kNow), kNow + microseconds(25));
}

TEST_F(JobChecksTest, LooksForTheEndOfABudgetOnlyWhereSomethingActsThen) {
  EXPECT_EQ(checks_.end_of_budget(plain_, false, kNow), kNever);
  EXPECT_EQ(checks_.end_of_budget(exact_, true, kNow), kNever) << "it is known";
  for (const OnMiss reaction : {OnMiss::kContinue, OnMiss::kHold, OnMiss::kSkip, OnMiss::kError}) {
    specs_[2].on_overrun = reaction;
    EXPECT_FALSE(JobChecks::acts_at_end_of_budget(specs_[2]));
  }
  for (const OnMiss reaction : {OnMiss::kDemote, OnMiss::kAbort, OnMiss::kStop, OnMiss::kFlag}) {
    specs_[2].on_overrun = reaction;
    EXPECT_TRUE(JobChecks::acts_at_end_of_budget(specs_[2]));
  }
  specs_[2].budget = {};
  EXPECT_FALSE(JobChecks::acts_at_end_of_budget(specs_[2]));
}

TEST_F(JobChecksTest, OnlyAJobBehindAServerHasACapacity) {
  EXPECT_EQ(JobChecks::end_of_capacity(plain_, kNow), kNever);
  specs_[0].server = ServerSpec{ServerKind::kDeferrable, milliseconds(2), milliseconds(10)};
  JobThread sporadic(tasks_[0]);
  sporadic.start([&] { sporadic.attach(); });
  testing::join_and_await_end(sporadic);
  sporadic.sporadic->start(sporadic.thread(), kNow);
  std::uint32_t waiting = 1;
  (void)sporadic.sporadic->job().accept(waiting, kNow);
  (void)sporadic.sporadic->job().grant(kNow);
  EXPECT_EQ(JobChecks::end_of_capacity(sporadic, kNow), kNow + milliseconds(2));
  sporadic.is_demoted = true;
  EXPECT_EQ(JobChecks::end_of_capacity(sporadic, kNow), kNever);
}

}  // namespace
}  // namespace chimera
