// SPDX-License-Identifier: Apache-2.0
// For tests of jobs whose threads have ended.
#pragma once

#include "chimera/base/testing/await.h"
#include "chimera/runtime/preemptive/job_thread.h"

namespace chimera::testing {

/// Joins the thread of the job and waits until its CPU clock is gone: the kernel ends a thread a little after the one
/// that joins it goes on, and until then it uses time.
inline void join_and_await_end(JobThread& job) {
  job.join();
  EXPECT_TRUE(await_that([&] { return used_by(job.thread()) == kNever; }));
}

}  // namespace chimera::testing
