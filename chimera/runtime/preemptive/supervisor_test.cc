// SPDX-License-Identifier: Apache-2.0
#include "chimera/runtime/preemptive/supervisor.h"

#include <gtest/gtest.h>

#include <atomic>
#include <thread>

#include "chimera/runtime/testing/ended_thread.h"
#include "chimera/runtime/testing/preemptive_parts.h"

namespace chimera {
namespace {

struct SupervisorTest : testing::PreemptiveParts, ::testing::Test {
  Nanoseconds at(std::int64_t ms) const { return origin + milliseconds(ms); }
};

TEST_F(SupervisorTest, GivesAJobThatWaitsTheNewestReleaseAndDropsTheOthers) {
  add("late", milliseconds(10));
  make();
  JobThread& job = release(0, origin);
  supervisor().check_jobs(at(35));
  EXPECT_TRUE(job.phase.is_ready());
  EXPECT_EQ(job.job.release, at(30));
  EXPECT_EQ(job.job.deadline, at(40));
  EXPECT_EQ(job.next_release, at(40));
  EXPECT_EQ(job.task.profile.dropped, 3u);
  EXPECT_EQ(checks().due(job), at(40));
}

TEST_F(SupervisorTest, TakesAWaitingJobBackAtItsDeadlineWhenTheReactionIsAbort) {
  add("late", milliseconds(10)).on_miss = OnMiss::kAbort;
  make();
  JobThread& job = release(0, origin);
  supervisor().check_jobs(at(10));
  EXPECT_EQ(job.phase.value(), JobPhase::kCancelled);
  EXPECT_FALSE(job.task.is_busy);
  EXPECT_EQ(ready().size(), 0u);
  EXPECT_EQ(job.task.profile.missed, 1u);
  EXPECT_EQ(checks().due(job), kNever);
}

TEST_F(SupervisorTest, HoldsATaskThatOthersNeverLetStart) {
  add("late", milliseconds(10)).max_consecutive = 2;
  make();
  JobThread& job = release(0, origin);
  const std::uint32_t rung = processor().edge_bell().read();
  supervisor().check_jobs(at(15));
  EXPECT_TRUE(job.phase.is_ready()) << "one miss";
  EXPECT_FALSE(job.is_held);
  supervisor().check_jobs(at(25));
  EXPECT_EQ(job.phase.value(), JobPhase::kCancelled);
  EXPECT_TRUE(job.is_held);
  EXPECT_NE(processor().edge_bell().read(), rung);
}

TEST_F(SupervisorTest, DemotesAJobThatIsNotOverAtItsDeadline) {
  add("late", milliseconds(10)).on_miss = OnMiss::kDemote;
  make();
  JobThread& job = begin(0, origin);
  supervisor().check_jobs(at(10));
  EXPECT_TRUE(job.phase.is_running());
  EXPECT_TRUE(job.is_demoted);
  EXPECT_EQ(job.task.profile.demoted, 1u);
  EXPECT_EQ(ready().size(), 0u);
  EXPECT_TRUE(releases().misses().is_reported_late(job.id));
}

TEST_F(SupervisorTest, ActsOnABudgetOnce) {
  TaskSpec& spec = add("over", milliseconds(10));
  spec.budget = milliseconds(20);
  spec.on_overrun = OnMiss::kAbort;
  make();
  JobThread& job = begin(0, origin);
  supervisor().check_running(at(0));
  EXPECT_FALSE(job.task.give_up.load(std::memory_order_relaxed));
  use(milliseconds(21));
  supervisor().check_running(at(1));
  EXPECT_TRUE(job.task.give_up.load(std::memory_order_relaxed));
  EXPECT_TRUE(releases().misses().is_reported_overrun(job.id));
}

TEST_F(SupervisorTest, KeepsAJobThatUsedTenTimesABudgetOfMicroseconds) {
  add("small", microseconds(500)).budget = microseconds(5);
  make();
  JobThread& job = begin(0, origin);
  use(microseconds(130));
  supervisor().check_running(at(1));
  EXPECT_FALSE(job.is_demoted);
  EXPECT_FALSE(supervisor().pop_hanging(job));
  EXPECT_TRUE(releases().misses().is_reported_overrun(job.id));
}

TEST_F(SupervisorTest, GivesUpAJobThatUsedMoreThanTheRuleAllows) {
  add("loops", milliseconds(1)).budget = microseconds(100);
  make();
  JobThread& job = begin(0, origin);
  use(microseconds(5100));
  supervisor().check_running(at(2));
  EXPECT_TRUE(job.is_demoted);
  EXPECT_TRUE(supervisor().pop_hanging(job));
  EXPECT_FALSE(supervisor().pop_hanging(job)) << "reported once";
  supervisor().check_running(at(3));
  EXPECT_FALSE(supervisor().pop_hanging(job));
  supervisor().check_jobs(at(10));
  EXPECT_FALSE(supervisor().pop_hanging(job)) << "a job that was given up is looked at, and not given up again";
}

TEST_F(SupervisorTest, NoticesThatTheThreadOfAJobIsGone) {
  add("dies", milliseconds(10)).budget = milliseconds(1);
  make();
  JobThread& job = begin(0, origin);
  job.start([&job] { job.attach(); });
  testing::join_and_await_end(job);
  supervisor().check_running(at(1));
  EXPECT_TRUE(job.phase.is_idle());
  EXPECT_FALSE(job.task.is_busy);
  EXPECT_TRUE(supervisor().pop_hanging(job));
  EXPECT_EQ(ready().size(), 0u);
}

TEST_F(SupervisorTest, GivesUpAJobThatSleepsForTwoSecondsAndTenPeriods) {
  add("sleeps", milliseconds(100)).budget = milliseconds(100);
  make();
  JobThread& job = begin(0, origin);
  std::atomic<bool> is_there{false}, is_over{false};
  std::atomic<std::uint32_t> word{0};
  job.start([&] {  // sleeps, so that its execution time stands still
    job.attach();
    is_there = true;
    while (!is_over) (void)Doorbell(word).wait_until(0, kNever);
  });
  while (!is_there || !is_asleep(job.thread())) std::this_thread::yield();
  for (int ms = 100; ms <= 2100; ms += 100) {
    supervisor().check_running(at(ms));
    EXPECT_FALSE(supervisor().pop_hanging(job)) << ms;
  }
  supervisor().check_running(at(2200));
  EXPECT_TRUE(supervisor().pop_hanging(job));
  is_over = true;
  Doorbell(word).ring();
  job.join();
}

TEST_F(SupervisorTest, HaltsAJobWithoutCapacityAndResumesItWhenThereIsSome) {
  TaskSpec& spec = add("events", milliseconds(100));
  spec.aperiodic = true;
  spec.server = ServerSpec{ServerKind::kDeferrable, milliseconds(20), milliseconds(100)};
  make();
  std::uint32_t waiting = 1;
  (void)job(0).sporadic->job().accept(waiting, origin);
  JobThread& job = begin(0, origin);
  supervisor().check_jobs(origin);
  EXPECT_FALSE(job.sporadic->is_halted());
  use(milliseconds(21));
  supervisor().check_jobs(at(30));
  EXPECT_TRUE(job.sporadic->is_halted());
  EXPECT_EQ(job.task.profile.exhausted, 1u);
  EXPECT_EQ(ready().size(), 0u);
  EXPECT_EQ(checks().due(job), at(100));
  supervisor().check_jobs(at(200));
  EXPECT_FALSE(job.sporadic->is_halted());
  EXPECT_EQ(ready().most_urgent(), &job);
  EXPECT_TRUE(job.phase.is_running());
}

TEST_F(SupervisorTest, DemotesTheLeastImportantReadyJobWhenTheShareIsUsedUp) {
  add("important", milliseconds(10)).criticality = 2;
  add("less", milliseconds(10)).criticality = 1;
  ProcessorPlace limited;
  limited.share = milliseconds(5);
  limited.window = milliseconds(10);
  make(Policy::kMuf, limited);
  JobThread& less = begin(1, origin);
  supervisor().keep_share(at(1), nullptr);
  EXPECT_FALSE(less.is_demoted);
  JobThread& important = release(0, at(6));
  supervisor().keep_share(at(6), &important);
  EXPECT_TRUE(less.is_demoted);
  EXPECT_TRUE(important.phase.is_ready());
  EXPECT_EQ(parts->share.pop_demoted(), less.id);
}

}  // namespace
}  // namespace chimera
