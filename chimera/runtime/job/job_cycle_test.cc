// SPDX-License-Identifier: Apache-2.0
#include "chimera/runtime/job/job_cycle.h"

#include <gtest/gtest.h>

#include "chimera/runtime/testing/bare_tasks.h"

namespace chimera {
namespace {

using testing::BareTasks;
using testing::kFirst;

struct JobCycleTest : ::testing::Test {
  JobCycleTest() {
    bare.first().cycle = [](void* instance, const chimera_call*) -> std::int32_t {
      const auto* self = static_cast<BareTasks*>(instance);
      EXPECT_TRUE(self->tasks[0].is_busy);
      return answer;
    };
    answer = CHIMERA_OK;
  }
  /// The job released at 10 ms, begun at 11 ms. True when it left something to settle.
  bool run(Nanoseconds end, Nanoseconds used = milliseconds(1)) {
    CycleTime time;
    const Job job = BareTasks::job(kFirst, 10);
    const BodyEnd body = jobs.open_and_begin(job, time, false);
    return jobs.close_and_conclude(job, time, body, milliseconds(11), end, used);
  }
  Profile& profile() { return bare.first().profile; }

  static inline std::int32_t answer = CHIMERA_OK;
  BareTasks bare;
  MissPolicy misses{bare.tasks, bare.records, bare.context_tap, nullptr, bare.clock};
  JobCycle jobs{bare.records, bare.context_tap, misses, nullptr, bare.clock, true};
};

TEST_F(JobCycleTest, AGoodJobInTimePublishesAndLeavesNothing) {
  EXPECT_FALSE(run(milliseconds(12)));
  EXPECT_EQ(profile().cycles, 1u);
  EXPECT_EQ(bare.first().group.sequence(), 1u);
  EXPECT_EQ(profile().response.max, milliseconds(2));
  EXPECT_EQ(profile().start_delay.max, milliseconds(1));
  EXPECT_FALSE(bare.first().is_busy);
}

TEST_F(JobCycleTest, AJobOfATaskThatToleratesMissesIsRemembered) {
  bare.specs[0].tolerated_misses = 1;
  bare.specs[0].tolerated_of = 4;
  bare.records[0].is_plain = false;
  (void)run(milliseconds(21));
  (void)run(milliseconds(12));
  EXPECT_FALSE(bare.records[0].history.would_tolerate(bare.specs[0])) << "one miss of four was there";
}

TEST_F(JobCycleTest, ALateJobIsJudgedAndHeld) {
  bare.specs[0].on_miss = OnMiss::kHold;
  EXPECT_FALSE(run(milliseconds(21)));
  EXPECT_EQ(profile().missed, 1u);
  EXPECT_EQ(profile().held, 1u);
  EXPECT_EQ(profile().cycles, 0u);
  EXPECT_EQ(bare.first().group.sequence(), 0u);
}

TEST_F(JobCycleTest, AJobThatWasReportedLateStaysLateAtItsEnd) {
  CycleTime time;
  const Job job = BareTasks::job(kFirst, 10);
  const BodyEnd body = jobs.open_and_begin(job, time, false);
  misses.report_late(job, true);
  (void)jobs.close_and_conclude(job, time, body, milliseconds(11), milliseconds(20), milliseconds(1));
  EXPECT_EQ(profile().missed, 1u);
  EXPECT_FALSE(run(milliseconds(12))) << "of the next job nothing was reported";
  EXPECT_EQ(profile().missed, 1u);
}

TEST_F(JobCycleTest, AFaultThatIsNotRecoveredEndsInErrorAndIsToBeSettled) {
  bare.recovers = false;
  answer = CHIMERA_FAULT;
  EXPECT_TRUE(run(milliseconds(12)));
  EXPECT_EQ(bare.first().state, State::kError);
  EXPECT_TRUE(bare.leaves(JobRecord::kSettle));
}

TEST_F(JobCycleTest, WithoutAListenerAFaultIsSeenAndNotLeft) {
  JobCycle unheard(bare.records, bare.context_tap, misses, nullptr, bare.clock, false);
  record_fault(bare.first(), Method::kCycle, "as told", milliseconds(1));
  CycleTime time;
  const Job job = BareTasks::job(kFirst, 10);
  const BodyEnd body = unheard.open_and_begin(job, time, false);
  EXPECT_FALSE(unheard.close_and_conclude(job, time, body, milliseconds(11), milliseconds(12), milliseconds(1)));
  EXPECT_EQ(bare.records[0].faults_seen, 1u);
}

TEST_F(JobCycleTest, TooManyMissesInARowEndTheTask) {
  bare.specs[0].max_consecutive = 2;
  EXPECT_FALSE(run(milliseconds(21)));
  EXPECT_TRUE(run(milliseconds(21)));
  EXPECT_EQ(bare.first().state, State::kError);
  EXPECT_STREQ(bare.first().faults.last.text, "missed as many deadlines in a row as max_consecutive allows");
}

TEST_F(JobCycleTest, TheNextCompletedCycleGetsTheDroppedReleases) {
  bare.records[0].dropped = 3;
  bare.specs[0].on_miss = OnMiss::kHold;
  (void)run(milliseconds(21));
  EXPECT_EQ(bare.records[0].dropped, 3u) << "nothing was published";
  (void)run(milliseconds(12));
  EXPECT_EQ(bare.records[0].dropped, 0u);
}

TEST_F(JobCycleTest, StartsWhileItsMarginIsLeft) {
  bare.records[0].start_margin = milliseconds(4);
  bare.specs[0].min_time = milliseconds(4);
  bare.specs[0].on_miss = OnMiss::kHold;
  EXPECT_TRUE(jobs.may_start(BareTasks::job(kFirst, 10), milliseconds(16)));
  EXPECT_FALSE(jobs.may_start(BareTasks::job(kFirst, 10), milliseconds(16) + Nanoseconds{1}));
}

}  // namespace
}  // namespace chimera
