// SPDX-License-Identifier: Apache-2.0
#include "chimera/runtime/preemptive/job_thread.h"

#include <gtest/gtest.h>

#include "chimera/runtime/testing/ended_thread.h"

namespace chimera {
namespace {

class JobThreadTest : public ::testing::Test {
 protected:
  JobThreadTest() {
    spec_.period = milliseconds(1);
    task_.spec = &spec_;
    task_.id = TaskId(0u);
  }

  TaskSpec spec_;
  Task task_;
};

TEST_F(JobThreadTest, CountsTheTimeOfItsThreadFromTheBeginOfTheJob) {
  JobThread job(task_);
  Nanoseconds used, passed;
  job.start([&] {
    job.attach();
    const Nanoseconds end = used_by_this_thread() + milliseconds(5);
    while (used_by_this_thread() < end) {
    }
    const Nanoseconds before = used_by_this_thread();
    job.begin_use();
    used = job.used();
    passed = used_by_this_thread() - before;
  });
  testing::join_and_await_end(job);
  EXPECT_LE(used, passed) << "time before the job does not count";
  EXPECT_GE(job.used_before(), milliseconds(5));
  EXPECT_EQ(job.used(), Nanoseconds{}) << "the thread is gone";
}

TEST_F(JobThreadTest, LosesNoWakeThatCameBeforeTheWait) {
  JobThread job(task_);
  const std::uint32_t heard = job.heard();
  job.wake();
  job.wait(heard, kNever);
}

// A job that is preempted between its begin and its first reading of the clock began when it continued.
TEST_F(JobThreadTest, TheFirstSliceBeginsOnce) {
  JobThread job(task_);
  EXPECT_EQ(job.slice(), kNever);
  job.begin_first_slice(milliseconds(3));
  EXPECT_EQ(job.slice(), milliseconds(3));
  job.begin_slice(milliseconds(5));
  job.begin_first_slice(milliseconds(4));
  EXPECT_EQ(job.slice(), milliseconds(5));
}

TEST_F(JobThreadTest, TakesNoReleaseAtTheEndOfItsReleasesOrLater) {
  JobThread job(task_);
  job.next_release = milliseconds(3);
  EXPECT_TRUE(job.takes_release()) << "without an end";
  EXPECT_EQ(job.newest_release(milliseconds(3)), milliseconds(3));
  EXPECT_EQ(job.newest_release(microseconds(6900)), milliseconds(6));
  job.release_end = milliseconds(5);
  EXPECT_TRUE(job.takes_release());
  EXPECT_EQ(job.newest_release(microseconds(6900)), milliseconds(4)) << "the one at the end is not taken";
  job.release_end = milliseconds(3);
  EXPECT_FALSE(job.takes_release());
}

TEST_F(JobThreadTest, SaysInWhichMethodItsJobIs) {
  JobThread job(task_);
  EXPECT_EQ(job.method(), Method::kCycle);
  task_.job_method = Method::kError;
  EXPECT_EQ(job.method(), Method::kError);
}

}  // namespace
}  // namespace chimera
