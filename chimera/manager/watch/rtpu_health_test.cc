// SPDX-License-Identifier: Apache-2.0
#include "chimera/manager/watch/rtpu_health.h"

#include <gtest/gtest.h>
#include <sched.h>

namespace chimera::manager {
namespace {

TEST(RtpuHealth, ReadsTheGrantedRights) {
  const auto all = GrantedRights::of("Real-time OK: memory locked, pinned to CPU 1, SCHED_FIFO 80. Kernel limit ...");
  EXPECT_EQ(all.level, 80);
  EXPECT_EQ(all.cpu, 1);
  EXPECT_TRUE(all.is_locked);
  const auto none = GrantedRights::of(
      "WARNING: not real time\n  SCHED_FIFO 80 refused (Operation not permitted): set "
      "RLIMIT_RTPRIO to 80\n  memory not locked (x)\n  CPU 7 refused, runs unpinned");
  EXPECT_EQ(none.level, 0);
  EXPECT_EQ(none.cpu, -1);
  EXPECT_FALSE(none.is_locked);
}

TEST(RtpuHealth, NamesTheRightsThatWereLost) {
  const GrantedRights granted{80, 1, true};
  EXPECT_EQ(lost_rights(granted, false, {{7, SCHED_FIFO, 80, 1}}, true), "");
  EXPECT_EQ(lost_rights(granted, false, {{7, SCHED_OTHER, 0, 1}}, true),
            "thread 7 runs at SCHED_OTHER instead of SCHED_FIFO 80");
  EXPECT_EQ(
      lost_rights(granted, false, {{7, SCHED_FIFO, 99, -1}}, false),
      "thread 7 runs at SCHED_FIFO 99 instead of SCHED_FIFO 80, thread 7 is not bound to CPU 1 any more, memory is "
      "not locked any more");
  EXPECT_EQ(lost_rights({0, -1, false}, false, {{7, SCHED_RR, 3, -1}}, true),
            "thread 7 runs at SCHED_RR 3 instead of SCHED_OTHER");
}

// The levels of its threads change with their jobs, and go below all others when one is demoted.
TEST(RtpuHealth, APreemptiveRtpuMayHaveAnyLevelUpToTheGrantedOne) {
  const GrantedRights granted{80, 1, true};
  EXPECT_EQ(lost_rights(granted, true, {{7, SCHED_FIFO, 61, 1}, {8, SCHED_OTHER, 0, 1}}, true), "");
  EXPECT_EQ(lost_rights(granted, true, {{7, SCHED_FIFO, 81, 1}}, true),
            "thread 7 runs at SCHED_FIFO 81 instead of SCHED_FIFO 80");
}

}  // namespace
}  // namespace chimera::manager
