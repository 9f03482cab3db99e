// SPDX-License-Identifier: Apache-2.0
#include "chimera/runtime/preemptive/job_phase.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <functional>
#include <utility>
#include <vector>

namespace chimera {
namespace {

using Move = std::function<void(JobPhase&)>;

struct NamedMove {
  const char* name;
  Move move;
  std::vector<std::pair<JobPhase::Value, JobPhase::Value>> legal;
};

const NamedMove kMoves[] = {
    {"release", [](JobPhase& job) { job.release(); }, {{JobPhase::kIdle, JobPhase::kReady}}},
    {"finish", [](JobPhase& job) { job.finish(); }, {{JobPhase::kRunning, JobPhase::kEnded}}},
    {"retire", [](JobPhase& job) { job.retire(); }, {{JobPhase::kEnded, JobPhase::kIdle}}},
    {"unclaim", [](JobPhase& job) { job.unclaim(); }, {{JobPhase::kClaimed, JobPhase::kReady}}},
    {"cancel", [](JobPhase& job) { job.cancel(); }, {{JobPhase::kClaimed, JobPhase::kCancelled}}},
    {"begin_method", [](JobPhase& job) { job.begin_method(); },
     {{JobPhase::kIdle, JobPhase::kMethod}, {JobPhase::kCancelled, JobPhase::kMethod}}},
    {"end_method", [](JobPhase& job) { job.end_method(); }, {{JobPhase::kMethod, JobPhase::kEnded}}},
    {"lose_thread", [](JobPhase& job) { job.lose_thread(); }, {{JobPhase::kRunning, JobPhase::kIdle}}},
};

constexpr JobPhase::Value kPhases[] = {JobPhase::kIdle,    JobPhase::kReady, JobPhase::kClaimed, JobPhase::kCancelled,
                                       JobPhase::kRunning, JobPhase::kEnded, JobPhase::kMethod};

/// Along the moves of the picture. A phase is never copied: threads know where it is.
void bring(JobPhase& job, JobPhase::Value phase) {
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

TEST(JobPhase, MakesEveryMoveOfThePicture) {
  for (const NamedMove& one : kMoves)
    for (const auto& [from, to] : one.legal) {
      JobPhase job;
      bring(job, from);
      ASSERT_EQ(job.value(), from);
      one.move(job);
      EXPECT_EQ(job.value(), to) << one.name << " from " << static_cast<int>(from);
    }
}

TEST(JobPhaseDeathTest, EndsTheProgramAtEveryOtherMove) {
  for (const NamedMove& one : kMoves)
    for (const JobPhase::Value from : kPhases) {
      if (std::any_of(one.legal.begin(), one.legal.end(), [from](const auto& move) { return move.first == from; }))
        continue;
      JobPhase job;
      bring(job, from);
      EXPECT_DEATH(one.move(job), "value|is_free") << one.name << " from " << static_cast<int>(from);
    }
}

TEST(JobPhase, BeginsOrIsClaimedOnlyWhenReady) {
  for (const JobPhase::Value from : kPhases) {
    JobPhase begun, claimed;
    bring(begun, from);
    bring(claimed, from);
    const bool is_ready = from == JobPhase::kReady;
    EXPECT_EQ(begun.try_begin(), is_ready);
    EXPECT_EQ(begun.value(), is_ready ? JobPhase::kRunning : from);
    EXPECT_EQ(claimed.try_claim(), is_ready);
    EXPECT_EQ(claimed.value(), is_ready ? JobPhase::kClaimed : from);
  }
}

TEST(JobPhase, AcknowledgesOnlyACancel) {
  for (const JobPhase::Value from : kPhases) {
    JobPhase job;
    bring(job, from);
    job.acknowledge_cancel();
    EXPECT_EQ(job.value(), from == JobPhase::kCancelled ? JobPhase::kIdle : from) << "a method goes on";
  }
}

TEST(JobPhase, IsFreeForAnEdgeWithoutAJobAndWithACancelledOne) {
  for (const JobPhase::Value phase : kPhases) {
    JobPhase job;
    bring(job, phase);
    EXPECT_EQ(job.is_free(), phase == JobPhase::kIdle || phase == JobPhase::kCancelled);
    EXPECT_EQ(job.is_idle(), phase == JobPhase::kIdle);
    EXPECT_EQ(job.is_ready(), phase == JobPhase::kReady);
    EXPECT_EQ(job.is_running(), phase == JobPhase::kRunning);
    EXPECT_EQ(job.has_ended(), phase == JobPhase::kEnded);
  }
}

}  // namespace
}  // namespace chimera
