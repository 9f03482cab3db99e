// SPDX-License-Identifier: Apache-2.0
#include "chimera/runtime/preemptive/job_thread.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <functional>
#include <vector>

#include "chimera/platform/linux_clock.h"

namespace chimera {
namespace {

using Move = std::function<void(JobThread&)>;

struct NamedMove {
  const char* name;
  Move move;
  std::vector<std::pair<JobPhase, JobPhase>> legal;
};

const NamedMove kMoves[] = {
    {"release", [](JobThread& job) { job.release(); }, {{JobPhase::kIdle, JobPhase::kReady}}},
    {"finish", [](JobThread& job) { job.finish(); }, {{JobPhase::kRunning, JobPhase::kEnded}}},
    {"retire", [](JobThread& job) { job.retire(); }, {{JobPhase::kEnded, JobPhase::kIdle}}},
    {"unclaim", [](JobThread& job) { job.unclaim(); }, {{JobPhase::kClaimed, JobPhase::kReady}}},
    {"cancel", [](JobThread& job) { job.cancel(); }, {{JobPhase::kClaimed, JobPhase::kCancelled}}},
    {"begin_method", [](JobThread& job) { job.begin_method(); },
     {{JobPhase::kIdle, JobPhase::kMethod}, {JobPhase::kCancelled, JobPhase::kMethod}}},
    {"end_method", [](JobThread& job) { job.end_method(); }, {{JobPhase::kMethod, JobPhase::kEnded}}},
    {"lose_thread", [](JobThread& job) { job.lose_thread(); }, {{JobPhase::kRunning, JobPhase::kIdle}}},
};

constexpr JobPhase kPhases[] = {JobPhase::kIdle,    JobPhase::kReady, JobPhase::kClaimed, JobPhase::kCancelled,
                                JobPhase::kRunning, JobPhase::kEnded, JobPhase::kMethod};

class JobThreadTest : public testing::Test {
 protected:
  JobThreadTest() {
    spec_.period = milliseconds(1);
    task_.spec = &spec_;
    task_.id = TaskId(0u);
  }
  /// Along the moves of the picture. A JobThread is never copied: threads know where it is.
  void bring(JobThread& job, JobPhase phase) {
    if (phase == JobPhase::kIdle) return;
    if (phase == JobPhase::kMethod) return job.begin_method();
    job.release();
    if (phase == JobPhase::kReady) return;
    if (phase == JobPhase::kClaimed || phase == JobPhase::kCancelled) {
      ASSERT_TRUE(job.try_claim());
      if (phase == JobPhase::kCancelled) job.cancel();
      return;
    }
    ASSERT_TRUE(job.try_begin());
    if (phase == JobPhase::kEnded) job.finish();
  }

  TaskSpec spec_;
  Task task_;
};
using JobThreadDeathTest = JobThreadTest;

TEST_F(JobThreadTest, MakesEveryMoveOfThePicture) {
  for (const NamedMove& one : kMoves)
    for (const auto& [from, to] : one.legal) {
      JobThread job(task_);
      bring(job, from);
      ASSERT_EQ(job.phase(), from);
      one.move(job);
      EXPECT_EQ(job.phase(), to) << one.name << " from " << static_cast<int>(from);
    }
}

TEST_F(JobThreadDeathTest, EndsTheProgramAtEveryOtherMove) {
  for (const NamedMove& one : kMoves)
    for (const JobPhase from : kPhases) {
      if (std::any_of(one.legal.begin(), one.legal.end(), [from](const auto& move) { return move.first == from; }))
        continue;
      JobThread job(task_);
      bring(job, from);
      EXPECT_DEATH(one.move(job), "phase|is_free") << one.name << " from " << static_cast<int>(from);
    }
}

TEST_F(JobThreadTest, BeginsAndIsClaimedWhenReadyAndElseStaysWhereItIs) {
  for (const JobPhase from : kPhases) {
    JobThread begun(task_), claimed(task_);
    bring(begun, from);
    bring(claimed, from);
    const bool is_ready = from == JobPhase::kReady;
    EXPECT_EQ(begun.try_begin(), is_ready);
    EXPECT_EQ(begun.phase(), is_ready ? JobPhase::kRunning : from);
    EXPECT_EQ(claimed.try_claim(), is_ready);
    EXPECT_EQ(claimed.phase(), is_ready ? JobPhase::kClaimed : from);
  }
}

TEST_F(JobThreadTest, AcknowledgesOnlyACancel) {
  for (const JobPhase from : kPhases) {
    JobThread job(task_);
    bring(job, from);
    job.acknowledge_cancel();
    EXPECT_EQ(job.phase(), from == JobPhase::kCancelled ? JobPhase::kIdle : from) << "a method goes on";
  }
}

TEST_F(JobThreadTest, IsFreeForAnEdgeWithoutAJobAndWithACancelledOne) {
  for (const JobPhase phase : kPhases) {
    JobThread job(task_);
    bring(job, phase);
    EXPECT_EQ(job.is_free(), phase == JobPhase::kIdle || phase == JobPhase::kCancelled);
    EXPECT_EQ(job.is_idle(), phase == JobPhase::kIdle);
    EXPECT_EQ(job.is_ready(), phase == JobPhase::kReady);
    EXPECT_EQ(job.is_running(), phase == JobPhase::kRunning);
    EXPECT_EQ(job.has_ended(), phase == JobPhase::kEnded);
  }
}

TEST_F(JobThreadTest, CountsWhatItsThreadUsesFromTheBeginningOfTheJobOn) {
  JobThread job(task_);
  Nanoseconds used;
  job.start([&] {
    job.attach();
    const Nanoseconds end = used_by_this_thread() + milliseconds(5);
    while (used_by_this_thread() < end) {
    }
    job.begin_use();
    used = job.used();
  });
  job.join();
  EXPECT_LT(used, milliseconds(5)) << "what came before is not the job's";
  EXPECT_GE(job.used_before(), milliseconds(5));
  EXPECT_EQ(job.used(), Nanoseconds{}) << "the thread is gone";
}

TEST_F(JobThreadTest, LosesNoWakeThatCameBeforeTheWait) {
  JobThread job(task_);
  const Nanoseconds begun = LinuxClock().now();
  const std::uint32_t heard = job.heard();
  job.wake();
  job.wait(heard, begun + seconds(20));
  EXPECT_LT(LinuxClock().now() - begun, seconds(10));
}

// A job that is preempted between its begin and its first look at the clock began when it went on.
TEST_F(JobThreadTest, TheFirstSliceBeginsOnce) {
  JobThread job(task_);
  EXPECT_EQ(job.slice(), kNever);
  job.begin_first_slice(milliseconds(3));
  EXPECT_EQ(job.slice(), milliseconds(3));
  job.begin_slice(milliseconds(5));
  job.begin_first_slice(milliseconds(4));
  EXPECT_EQ(job.slice(), milliseconds(5));
}

}  // namespace
}  // namespace chimera
