// SPDX-License-Identifier: Apache-2.0
// The moves of a job that its thread makes outside the section, while another thread claims the job.
#include <gtest/gtest.h>

#include <atomic>
#include <thread>

#include "chimera/runtime/preemptive/job_phase.h"

namespace chimera {
namespace {

// One thread begins what another one claims and gives back, or cancels: one of them has it at a time.
TEST(JobPhaseThreads, IsBegunOrCancelledWheneverBothAreTried) {
  constexpr int kRounds = 5'000;
  JobPhase job;
  std::atomic<int> round{0}, done{0};
  int begun = 0, cancelled = 0;
  std::thread thread([&] {
    for (int i = 1; i <= kRounds; ++i) {
      while (round.load() < i) std::this_thread::yield();
      while (job.is_ready() || job.value() == JobPhase::kClaimed)
        if (job.try_begin()) {
          ++begun;
          job.finish();
        }
      done.store(i);
    }
  });
  for (int i = 1; i <= kRounds; ++i) {
    job.release();
    round.store(i);
    while (i % 2 == 0 && job.is_ready()) std::this_thread::yield();  // every other one is left to the thread
    if (job.try_claim()) job.unclaim();
    if (job.try_claim()) {
      job.cancel();
      ++cancelled;
    }
    while (done.load() < i) std::this_thread::yield();
    if (job.has_ended()) job.retire();
    job.acknowledge_cancel();
    EXPECT_TRUE(job.is_idle());
  }
  thread.join();
  EXPECT_EQ(begun + cancelled, kRounds);
  EXPECT_GE(begun, kRounds / 2);
}

}  // namespace
}  // namespace chimera
