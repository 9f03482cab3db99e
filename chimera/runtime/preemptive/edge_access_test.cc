// SPDX-License-Identifier: Apache-2.0
#include "chimera/runtime/preemptive/edge_access.h"

#include <gtest/gtest.h>

#include <atomic>
#include <functional>
#include <thread>
#include <utility>

#include "chimera/runtime/testing/preemptive_parts.h"

namespace chimera {
namespace {

struct EdgeAccessTest : testing::PreemptiveParts, ::testing::Test {
  EdgeAccessTest() {
    add("one", milliseconds(10));
    add("two", milliseconds(20));
    make();
    access().attach();
  }
  Nanoseconds at(std::int64_t ms) const { return origin + milliseconds(ms); }
  ~EdgeAccessTest() override { testing::Idle::during_off = nullptr; }
  /// Calls the method off of the task, in which `during` is called.
  void off(std::uint32_t task, std::function<void()> during) {
    testing::Idle::during_off = std::move(during);
    EXPECT_EQ(access().call(job(task).task, Method::kOff, at(0)), Answer::kOk);
  }
  /// Acts as an edge.
  void settle(std::uint32_t task, Nanoseconds now) { releases().settlement().settle_at_once(TaskId(task), now); }
};

TEST_F(EdgeAccessTest, ClaimsATaskWithoutAJob) {
  EXPECT_TRUE(access().claim(TaskId(0u)));
  EXPECT_FALSE(job(0).is_awaited);
}

TEST_F(EdgeAccessTest, TakesAJobBackThatHasNotBegun) {
  JobThread& one = release(0, at(10));
  EXPECT_TRUE(access().claim(TaskId(0u)));
  EXPECT_EQ(one.phase.value(), JobPhase::kCancelled);
  EXPECT_EQ(one.next_release, at(10)) << "it comes again";
  EXPECT_EQ(ready().size(), 0u);
  EXPECT_TRUE(access().claim(TaskId(0u))) << "its thread has not noticed yet";
}

TEST_F(EdgeAccessTest, ComesAgainAtTheEndOfAJobThatHasBegun) {
  JobThread& one = begin(0, at(10));
  EXPECT_FALSE(access().claim(TaskId(0u)));
  EXPECT_TRUE(one.is_awaited);
  EXPECT_TRUE(one.phase.is_running());
}

TEST_F(EdgeAccessTest, RunsAMethodAtTheLabelOfTheTask) {
  begin(1, at(0));
  bool was_called = false;
  processor().enter();
  off(0, [&] {
    was_called = true;
    EXPECT_EQ(job(0).phase.value(), JobPhase::kMethod);
    EXPECT_TRUE(job(0).is_held);
    EXPECT_EQ(ready().size(), 2u);
    processor().enter();  // the section is free during the method
    processor().leave();
  });
  EXPECT_TRUE(was_called);
  EXPECT_TRUE(job(0).phase.is_idle());
  EXPECT_EQ(ready().size(), 1u);
  processor().leave();
}

// The thread of a job that was taken back notices that while the method runs.
TEST_F(EdgeAccessTest, AMethodIsNotOverWhenTheThreadNoticesThatItsJobWasTakenBack) {
  JobThread& one = release(0, at(10));
  EXPECT_TRUE(access().claim(TaskId(0u)));
  processor().enter();
  off(0, [&] {
    EXPECT_FALSE(one.phase.try_begin());
    one.phase.acknowledge_cancel();
    EXPECT_EQ(one.phase.value(), JobPhase::kMethod);
  });
  EXPECT_TRUE(one.phase.is_idle());
  processor().leave();
}

TEST_F(EdgeAccessTest, KeepsTheSectionForATaskWithAJobUnderWay) {
  JobThread& one = begin(0, at(10));
  processor().enter();
  off(0, [&] { EXPECT_TRUE(one.phase.is_running()); });
  EXPECT_TRUE(one.phase.is_running());
  processor().leave();
}

TEST_F(EdgeAccessTest, LooksUpALateJobOnceBeforeTheEdgeReportsIt) {
  std::atomic<bool> is_there{false}, is_over{false};
  std::atomic<std::uint32_t> word{0};
  JobThread& one = begin(0, at(0));
  one.start([&] {
    one.attach();
    one.begin_use();
    is_there = true;
    while (!is_over) (void)Doorbell(word).wait_until(0, kNever);
  });
  while (!is_there || !is_asleep(one.thread())) std::this_thread::yield();
  EXPECT_FALSE(access().collect_late(at(9)));
  releases().misses().report_late(one.job, true);
  EXPECT_FALSE(access().is_blocked(one.id));
  ASSERT_TRUE(access().collect_late(at(10)));
  access().look_up_blocked();
  EXPECT_FALSE(access().collect_late(at(10)));
  EXPECT_TRUE(access().is_blocked(one.id));
  settle(0, at(10));
  ASSERT_EQ(parts->guest.verdicts.size(), 1u);
  EXPECT_TRUE(parts->guest.verdicts[0].is_blocked);
  access().forget_blocked();
  EXPECT_FALSE(access().is_blocked(one.id));
  is_over = true;
  Doorbell(word).ring();
  one.join();
}

TEST_F(EdgeAccessTest, LooksUpNothingThatTheEdgeDoesNotReport) {
  JobThread& one = begin(0, at(0));
  releases().misses().report_late(one.job, true);
  settle(0, at(10));
  EXPECT_EQ(parts->guest.verdicts.size(), 1u);
  releases().misses().forget_reports(one.id);
  releases().misses().report_late(one.job, true);
  EXPECT_FALSE(access().collect_late(at(109))) << "100 ms have not passed since the last report";
  EXPECT_TRUE(access().collect_late(at(110)));
}

TEST_F(EdgeAccessTest, AJobThatHasNotBegunIsNotBlocked) {
  JobThread& one = release(0, at(0));
  releases().misses().report_late(one.job, false);
  EXPECT_FALSE(access().collect_late(at(10)));
}

TEST_F(EdgeAccessTest, KnowsTheLatestReleaseThatAJobHasTaken) {
  release(0, at(10));
  release(1, at(20));
  EXPECT_EQ(access().latest_release(), at(20));
}

TEST_F(EdgeAccessTest, HoldsReleasesFromAnInstantOnUntilTheTaskIsLetGo) {
  access().open(at(100));
  job(0).next_release = at(20);
  job(1).next_release = at(40);
  access().hold_releases(at(30));
  EXPECT_TRUE(job(0).takes_release());
  EXPECT_FALSE(job(1).takes_release());
  access().let_release(TaskId(1u));
  EXPECT_TRUE(job(1).takes_release());
  EXPECT_EQ(job(0).release_end, at(30)) << "that of another task";
  access().hold_releases(at(200));
  EXPECT_EQ(job(1).release_end, at(100)) << "the run ends before";
}

TEST_F(EdgeAccessTest, ARunThatGoesOnKeepsHeldReleases) {
  access().open(at(100));
  access().hold_releases(at(30));
  access().let_release(TaskId(1u));
  access().open(at(200));
  EXPECT_EQ(job(0).release_end, at(30));
  EXPECT_EQ(job(1).release_end, at(200));
  access().let_release(TaskId(0u));
  EXPECT_EQ(job(0).release_end, at(200));
}

TEST_F(EdgeAccessTest, WakesAThreadWhoseReleaseCameWhileItWasHeld) {
  access().open(at(100));
  job(0).next_release = at(30);
  access().hold_releases(at(30));
  const std::uint32_t heard = job(0).heard();
  clock.time = at(29);
  access().let_release(TaskId(0u));
  EXPECT_EQ(job(0).heard(), heard) << "its own alarm wakes it";
  access().hold_releases(at(30));
  clock.time = at(30);
  access().let_release(TaskId(0u));
  EXPECT_NE(job(0).heard(), heard);
}

TEST_F(EdgeAccessTest, AJobReleasedBeforeAnInstantIsUnderWayOrWaits) {
  job(0).next_release = at(30);
  EXPECT_FALSE(access().has_job_before(TaskId(0u), at(30)));
  EXPECT_TRUE(access().has_job_before(TaskId(0u), at(31))) << "its thread has not taken it yet";
  job(0).is_on = false;
  EXPECT_FALSE(access().has_job_before(TaskId(0u), at(31)));
  job(0).is_on = true;
  begin(0, at(10));
  job(0).next_release = at(50);
  EXPECT_TRUE(access().has_job_before(TaskId(0u), at(30)));
}

TEST_F(EdgeAccessTest, AnAwaitedJobStaysAwaitedWhenItsTaskIsClaimed) {
  access().await_job(TaskId(0u));
  EXPECT_TRUE(job(0).is_awaited);
  EXPECT_TRUE(access().claim(TaskId(0u)));
  EXPECT_TRUE(job(0).is_awaited) << "awaiting and claiming are independent";
}

}  // namespace
}  // namespace chimera
