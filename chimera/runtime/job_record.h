// SPDX-License-Identifier: Apache-2.0
// What the runtime keeps of the jobs of one task, beside the Task itself.
#pragma once

#include <atomic>
#include <cstdint>

#include "chimera/base/time.h"
#include "chimera/runtime/miss_history.h"
#include "chimera/task/task.h"

namespace chimera {

/// One cache line a task: everything that a job touches beside the Task. Written by the thread of the task while a job
/// of it is under way, by edges otherwise; the atomics by both.
struct alignas(64) JobRecord {
  /// What a job leaves for the next edge to do: bits of `left`.
  enum Left : std::uint8_t {
    kSettle = 1,     ///< the state of the task, signals it sent or a fault are to be looked at
    kRaiseFlag = 2,  ///< the reaction `flag`
    kStop = 4,       ///< the reaction `stop`
    kFindCause = 8,  ///< a deadline was missed, and the cause is to be reported
    kSwitchForMiss = 16,     ///< the reaction `switch` of on_miss
    kSwitchForOverrun = 32,  ///< the reaction `switch` of on_overrun
  };
  /// What was reported of the present job before its end: bits of `reported`.
  enum Report : std::uint8_t {
    kLate = 1,           ///< its deadline came after it had begun
    kLateUnstarted = 2,  ///< its deadline came before it began
    kOverrun = 4,        ///< it used more than its budget
    kEnded = 8,          ///< it has ended: nothing more is reported of it before its end
  };

  Task* task = nullptr;
  Nanoseconds start_margin;  ///< a job starts while now + start_margin <= deadline
  Nanoseconds budget;        ///< of execution time for one job; kNever: none
  std::uint64_t told_seen = 0, faults_seen = 0;  ///< FaultRecord::told and count, as they were looked at last
  std::uint32_t dropped = 0;                     ///< releases since the last completed cycle
  bool skip_next = false;                        ///< the reaction `skip`: the next release is dropped
  bool is_on = false;                            ///< the task takes part in releases
  bool is_plain = true;                          ///< no miss is tolerated: a good job in time needs no judgement
  /// Bits set by the thread of the task (fetch_or) and taken by edges (fetch_and). Relaxed, pairs with nothing: what
  /// the bits speak of is ordered by JobThreads::claim, which an edge asks before it touches the task.
  std::atomic<std::uint8_t> left{0};
  /// fetch_or by whoever reports (an edge, the supervisor) pairs with the one at the end of the job, both acq_rel:
  /// of a report and the end exactly one sees the other. Cleared before anybody knows of the next job.
  std::atomic<std::uint8_t> reported{0};
  MissHistory history;  ///< kept where misses are tolerated
};

}  // namespace chimera
