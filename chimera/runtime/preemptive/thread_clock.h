// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "chimera/platform/clock.h"
#include "chimera/platform/thread.h"
#include "chimera/runtime/job/job_clock.h"

namespace chimera {

/// Time as jobs with threads of their own see it: to use time is to use that of the thread, however often it is
/// preempted. May be used by any thread.
class ThreadClock final : public JobClock {
 public:
  Nanoseconds now() noexcept override { return LinuxClock().now(); }
  /// Context: setup; blocks.
  void sleep(Nanoseconds time) noexcept { (void)LinuxClock().wait_until(now() + time); }
  void spend(Nanoseconds time) noexcept override {
    const Nanoseconds end = used_by_this_thread() + time;
    while (used_by_this_thread() < end) {
    }
  }
};

}  // namespace chimera
