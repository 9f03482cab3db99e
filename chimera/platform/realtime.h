// SPDX-License-Identifier: Apache-2.0
// Real-time rights of the calling thread: asked for, then looked up again, because a request that "succeeded" may
// still not hold (a cgroup, an emulated kernel, a zero budget).
#pragma once

#include <cstdint>
#include <string_view>

#include "chimera/base/fixed.h"
#include "chimera/base/time.h"

namespace chimera {

struct RealtimeRequest {
  int priority = 0;         ///< SCHED_FIFO 1..99; 0 leaves the thread as it is
  int cpu = -1;             ///< the only CPU to run on; -1: any
  bool lock_memory = true;  ///< no page of the process is ever fetched again
};

/// The words of RealtimeGrant::report behind which other processes read what was granted.
inline constexpr std::string_view kLevelWords = "SCHED_FIFO ", kPinnedWords = "pinned to CPU ",
                                  kLockedWords = "memory locked", kRefusedWords = " refused";

/// What of a RealtimeRequest is in force now. What was not asked for counts as granted.
struct RealtimeGrant {
  bool priority = false;
  bool cpu = false;
  bool memory = false;
  /// Of each period the kernel lets real-time threads run this share: 0.95 by default, 1 when not throttled.
  double throttle_share = 1;
  /// What was granted, in one line; or a line that begins with "WARNING" and below it, each in a line that begins
  /// with two spaces, what is missing with what to set, and what was granted.
  FixedString<400> report;

  bool is_complete() const noexcept { return priority && cpu && memory; }
};

/// Applies `request` to the calling thread (memory: the process), as far as the system allows. Nothing is fatal:
/// without rights the same program runs, late. Threads and processes that the thread starts from then on are ordinary
/// (SCHED_RESET_ON_FORK). Context: setup; may block.
RealtimeGrant enter_realtime(const RealtimeRequest& request) noexcept;

/// The share of a CPU that the kernel lets real-time threads have (sched_rt_runtime_us of sched_rt_period_us); 1: all.
/// Context: setup.
double realtime_share() noexcept;
/// The time of which that is a share (sched_rt_period_us). Context: setup.
Nanoseconds realtime_period() noexcept;

/// True when the system grants SCHED_FIFO at `priority` to this user. The calling thread is left as it was.
/// Context: setup.
bool may_be_realtime(int priority) noexcept;

}  // namespace chimera
