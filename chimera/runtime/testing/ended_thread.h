// SPDX-License-Identifier: Apache-2.0
// For tests of jobs whose threads have ended.
#pragma once

#include <chrono>
#include <thread>

#include "chimera/runtime/preemptive/job_thread.h"

namespace chimera::testing {

/// Joins the thread of the job and waits until its CPU clock is gone: the kernel ends a thread a little after the one
/// that joins it goes on, and until then it uses time.
inline void join_and_await_end(JobThread& job) {
  job.join();
  for (int i = 0; i < 10'000 && used_by(job.thread()) != kNever; ++i)
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
}

}  // namespace chimera::testing
