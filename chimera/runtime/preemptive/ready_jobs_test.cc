// SPDX-License-Identifier: Apache-2.0
// Without real-time levels: which job is the most urgent, and which level its own thread would take. What the kernel
// does with the levels is looked up by tests/conformance/*_realtime_test.cc.
#include "chimera/runtime/preemptive/ready_jobs.h"

#include <gtest/gtest.h>

#include "chimera/runtime/testing/preemptive_parts.h"

namespace chimera {
namespace {

struct ReadyJobsTest : testing::PreemptiveParts, ::testing::Test {
  Nanoseconds at(std::int64_t ms) const { return origin + milliseconds(ms); }
  void make_two(Policy policy = Policy::kEdf) {
    add("fast", milliseconds(10));
    add("slow", milliseconds(20));
    make(policy);
  }
};

TEST_F(ReadyJobsTest, KeepsJobsInOrderOfUrgency) {
  make_two();
  EXPECT_EQ(ready().most_urgent(), nullptr);
  JobThread &slow = release(1, at(0)), &fast = release(0, at(0));
  EXPECT_EQ(ready().size(), 2u);
  EXPECT_EQ(&ready()[0], &slow);
  EXPECT_EQ(ready().most_urgent(), &fast);
  ready().remove(fast);
  EXPECT_EQ(ready().most_urgent(), &slow);
  ready().remove(fast);
  EXPECT_EQ(ready().size(), 1u) << "it was not there";
}

TEST_F(ReadyJobsTest, KeepsEqualsInTheirOrderUntilOneHasBegun) {
  add("producer", milliseconds(10));
  add("reader", milliseconds(10));
  make();
  JobThread &reader = release(1, at(0)), &producer = release(0, at(0));
  EXPECT_EQ(ready().most_urgent(), &producer) << "its thread came later, and the other one has not begun";
  ready().remove(producer);
  ASSERT_TRUE(reader.phase.try_begin());
  (void)ready().insert(producer, ReadyJobs::deadline_of(producer), {}, &producer);
  EXPECT_EQ(ready().most_urgent(), &reader) << "a job that has begun goes on";
}

TEST_F(ReadyJobsTest, ReturnsTheLevelOfTheInsertedJob) {
  make_two();
  JobThread &slow = job(1), &fast = job(0);
  const int of_slow = ready().insert(slow, at(20), {}, &slow), of_fast = ready().insert(fast, at(10), {}, &fast);
  EXPECT_LT(of_slow, of_fast);
  EXPECT_EQ(ready().level_changes(), 0u) << "the system gives no levels";
  EXPECT_EQ(ready().count_wrong(), 0u);
}

TEST_F(ReadyJobsTest, FollowsADeadlineThatMoves) {
  make_two();
  release(1, at(0));
  JobThread& fast = release(0, at(0));
  fast.job.deadline = at(30);
  ready().rekey(fast, {});
  EXPECT_NE(ready().most_urgent(), &fast);
}

TEST_F(ReadyJobsTest, ComparesLaxitiesByTheQuantum) {
  add("one", milliseconds(10)).budget = microseconds(1000);
  add("two", milliseconds(10)).budget = microseconds(1100);
  make(Policy::kMufLaxity);
  JobThread& one = release(0, at(0));
  release(1, at(0));
  EXPECT_EQ(ready().most_urgent(), &one) << "100 us of 500 decide nothing: the first one goes on";
  ready().rekey(job(1), microseconds(2000));
  EXPECT_EQ(ready().most_urgent(), &job(1));
}

TEST_F(ReadyJobsTest, FindsTheMostUrgentJobThatHasBegun) {
  make_two();
  EXPECT_EQ(ready().most_urgent_running(), nullptr);
  JobThread& slow = begin(1, at(0));
  release(0, at(1));
  EXPECT_EQ(ready().most_urgent_running(), &slow);
  EXPECT_TRUE(job(0).phase.try_begin());
  EXPECT_EQ(ready().most_urgent_running(), &job(0));
}

TEST_F(ReadyJobsTest, AJobBehindAServerIsDueWithItsServer) {
  make_served(milliseconds(50), milliseconds(10), at(3));
  release(0, at(3));
  EXPECT_EQ(ReadyJobs::deadline_of(job(0)), at(50));
  EXPECT_EQ(ReadyJobs::deadline_of(release(1, at(0))), at(10));
}

TEST_F(ReadyJobsTest, AMoreUrgentJobTakesTheProcessor) {
  make_two();
  JobThread& slow = begin(1, at(0));
  EXPECT_EQ(processor().on_processor(), &slow);
  release(0, at(5));
  EXPECT_EQ(processor().on_processor(), &job(0));
  EXPECT_EQ(slow.task.profile.preempted, 1u);
  EXPECT_EQ(processor().seen().preemptions, 1u);
  ready().remove(job(0));
  processor().dispatch(at(7));
  EXPECT_EQ(processor().on_processor(), &slow);
  EXPECT_EQ(slow.slice(), at(7)) << "it goes on from here";
}

}  // namespace
}  // namespace chimera
