// SPDX-License-Identifier: Apache-2.0
#include "chimera/runtime/job/miss_policy.h"

#include <gtest/gtest.h>

#include <string_view>

#include "chimera/runtime/job/job_threads.h"
#include "chimera/runtime/testing/bare_tasks.h"

namespace chimera {
namespace {

using testing::BareTasks;
using testing::kFirst;

struct MissPolicyTest : ::testing::Test {
  /// A job of the first task, released at 10 ms, that ends at `end` having used `used`: may its result be published?
  bool judged(Nanoseconds end, Nanoseconds used = {}) {
    body = {};
    return misses.judge(BareTasks::job(kFirst, 10), body, end, used, misses.end_reports(kFirst));
  }
  TaskSpec& spec() { return bare.specs[0]; }
  Profile& profile() { return bare.first().profile; }

  BareTasks bare;
  JobsInLoop in_loop{bare.tasks, nullptr};
  MissCause cause{bare.tasks, in_loop, bare.heap};
  MissPolicy misses{bare.tasks, bare.records, bare.context_tap, &cause, bare.clock};
  BodyEnd body;
};

TEST_F(MissPolicyTest, PublishesALateResultAndLeavesItsCauseToBeFound) {
  EXPECT_TRUE(judged(milliseconds(21)));
  EXPECT_EQ(profile().missed, 1u);
  EXPECT_EQ(profile().missed_in_a_row, 1u);
  EXPECT_TRUE(bare.leaves(JobRecord::kFindCause));
  EXPECT_EQ(bare.recorded(), std::vector{TapKind::kMiss});
}

TEST_F(MissPolicyTest, ReactsToEachFailureAsTheTaskSays) {
  spec().on_miss = OnMiss::kHold;
  EXPECT_FALSE(judged(milliseconds(21)));
  spec().on_miss = OnMiss::kAbort;
  EXPECT_FALSE(judged(milliseconds(21)));
  EXPECT_EQ(body.answer, Answer::kAborted);
  spec().on_miss = OnMiss::kError;
  EXPECT_FALSE(judged(milliseconds(21)));
  EXPECT_EQ(body.answer, Answer::kFault);
  EXPECT_STREQ(bare.first().faults.last.text, "missed its deadline");
  spec().on_miss = OnMiss::kFlag;
  EXPECT_TRUE(judged(milliseconds(21)));
  EXPECT_TRUE(bare.leaves(JobRecord::kRaiseFlag));
  EXPECT_FALSE(bare.leaves(JobRecord::kStop));
  spec().on_miss = OnMiss::kStop;
  EXPECT_TRUE(judged(milliseconds(21)));
  EXPECT_TRUE(bare.leaves(JobRecord::kStop));
}

TEST_F(MissPolicyTest, HoldsTheResultOfAJobThatUsedMoreThanItsBudget) {
  spec().budget = bare.records[0].budget = milliseconds(2);
  spec().on_overrun = OnMiss::kHold;
  EXPECT_FALSE(judged(milliseconds(15), milliseconds(3)));
  EXPECT_EQ(profile().overrun, 1u);
  EXPECT_EQ(profile().missed, 0u);
}

TEST_F(MissPolicyTest, SkipDropsTheNextReleaseAndNoOther) {
  spec().on_miss = OnMiss::kSkip;
  EXPECT_TRUE(judged(milliseconds(21)));
  EXPECT_FALSE(misses.decide_start(BareTasks::job(kFirst, 20), milliseconds(21)));
  EXPECT_EQ(profile().dropped, 1u);
  EXPECT_EQ(profile().missed, 1u) << "dropped on purpose";
  EXPECT_FALSE(bare.records[0].skip_next);
}

TEST_F(MissPolicyTest, RefusesAndCountsAStartWithoutItsMinimumTime) {
  spec().min_time = milliseconds(4);
  spec().on_miss = OnMiss::kHold;
  EXPECT_FALSE(misses.decide_start(BareTasks::job(kFirst, 10), milliseconds(17)));
  EXPECT_EQ(profile().min_refused, 1u);
  EXPECT_EQ(profile().dropped, 1u);
  EXPECT_TRUE(bare.leaves(JobRecord::kSettle));
  spec().on_miss = OnMiss::kContinue;
  EXPECT_TRUE(misses.decide_start(BareTasks::job(kFirst, 20), milliseconds(27)));
}

TEST_F(MissPolicyTest, ToleratesAsManyMissesAsItsWindowAllows) {
  spec().on_miss = OnMiss::kHold;
  spec().tolerated_misses = 1;
  spec().tolerated_of = 3;
  EXPECT_TRUE(judged(milliseconds(21))) << "the first of three";
  EXPECT_FALSE(judged(milliseconds(21))) << "the second of three";
  EXPECT_EQ(profile().tolerated, 1u);
  for (int i = 0; i < 3; ++i) misses.count_good(bare.first());
  EXPECT_TRUE(judged(milliseconds(21)));
  EXPECT_EQ(profile().missed, 3u) << "a miss that is tolerated is counted";
}

TEST_F(MissPolicyTest, AReactionDuringTheJobIsNotRepeatedAtItsEnd) {
  spec().on_miss = OnMiss::kFlag;
  misses.report_late(BareTasks::job(kFirst, 10), true);
  EXPECT_TRUE(bare.leaves(JobRecord::kRaiseFlag));
  bare.records[0].left = 0;
  EXPECT_TRUE(judged(milliseconds(21)));
  EXPECT_EQ(bare.records[0].left, 0);
  EXPECT_EQ(profile().missed, 1u) << "the end counts it";
}

TEST_F(MissPolicyTest, NothingIsReportedAfterTheEndOfAJob) {
  (void)misses.end_reports(kFirst);
  misses.report_late(BareTasks::job(kFirst, 10), true);
  EXPECT_FALSE(misses.report_overrun(kFirst, 1, milliseconds(3), milliseconds(14)));
  EXPECT_EQ(bare.records[0].left, 0);
  misses.forget_reports(kFirst);
  EXPECT_TRUE(misses.report_overrun(kFirst, 2, milliseconds(3), milliseconds(24)));
  EXPECT_TRUE(misses.is_reported_overrun(kFirst));
  EXPECT_FALSE(misses.report_overrun(kFirst, 2, milliseconds(3), milliseconds(25))) << "once a job";
}

TEST_F(MissPolicyTest, AJobThatIsLateBeforeItBeginsNeitherFlagsNorStops) {
  spec().on_miss = OnMiss::kStop;
  misses.report_late(BareTasks::job(kFirst, 10), false);
  EXPECT_FALSE(bare.leaves(JobRecord::kStop));
  EXPECT_TRUE(bare.leaves(JobRecord::kFindCause));
  EXPECT_FALSE(misses.is_reported_late(kFirst));
}

TEST_F(MissPolicyTest, LosesPatienceByDroppedReleasesToo) {
  spec().max_consecutive = 3;
  misses.drop({kFirst, milliseconds(10), 2});
  EXPECT_FALSE(misses.has_lost_patience());
  misses.drop({kFirst, milliseconds(20), 1});
  EXPECT_TRUE(misses.has_lost_patience());
  misses.give_up(bare.first(), milliseconds(21));
  EXPECT_EQ(bare.first().state, State::kError) << "although its method error recovers";
  EXPECT_EQ(profile().missed_in_a_row, 0u);
}

TEST_F(MissPolicyTest, WithoutAListenerNoCauseIsSearched) {
  MissPolicy alone(bare.tasks, bare.records, bare.context_tap, nullptr, bare.clock);
  alone.drop({kFirst, milliseconds(10), 1});
  EXPECT_EQ(bare.records[0].left, 0);
}

TEST_F(MissPolicyTest, AbandonedAndUnstartedJobsAreMisses) {
  misses.abandon(BareTasks::job(kFirst, 10));
  misses.expire_unstarted(BareTasks::job(kFirst, 20));
  EXPECT_EQ(profile().missed, 2u);
  EXPECT_EQ(profile().dropped, 1u);
  const std::vector expected{TapKind::kMiss, TapKind::kRelease, TapKind::kMiss, TapKind::kDrop};
  EXPECT_EQ(bare.recorded(), expected);
}

}  // namespace
}  // namespace chimera
