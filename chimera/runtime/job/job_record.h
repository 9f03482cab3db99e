// SPDX-License-Identifier: Apache-2.0
// Record of the jobs of one task, beside the Task itself.
#pragma once

#include <cstdint>

#include "chimera/base/mechanisms.h"
#include "chimera/base/part_if.h"
#include "chimera/base/shared_word.h"
#include "chimera/base/time.h"
#include "chimera/runtime/job/miss_history.h"
#include "chimera/task/task.h"

namespace chimera {

/// One cache line a task: everything that a job touches beside the Task. The thread of the task writes it while a job
/// of it is under way, cycle boundaries otherwise; both write the atomics.
struct alignas(kCacheLine) JobRecord {
  /// Work that a job leaves for the next cycle boundary: bits of `left`.
  enum Left : std::uint8_t {
    kSettle = 1,     ///< the state of the task, signals it sent or a fault are to be looked at
    kRaiseFlag = 2,  ///< the reaction `flag`
    kStop = 4,       ///< the reaction `stop`
    kFindCause = 8,  ///< a deadline was missed, and the cause is to be reported
    kSwitchForMiss = 16,     ///< the reaction `switch` of on_miss
    kSwitchForOverrun = 32,  ///< the reaction `switch` of on_overrun
  };
  /// Reports about the present job before its end: bits of `reported`.
  enum Report : std::uint8_t {
    kLate = 1,           ///< its deadline came after it had begun
    kLateUnstarted = 2,  ///< its deadline came before it began
    kOverrun = 4,        ///< it used more than its budget
    kEnded = 8,          ///< it has ended: no more reports until the next job
  };

  Task* task = nullptr;
  /// A job starts while now + start_margin <= deadline.
  [[no_unique_address]] ValueIf<mechanisms::kReactions, Nanoseconds> start_margin;
  /// The execution time of one job stays within it; kNever: no limit.
  [[no_unique_address]] ValueIf<mechanisms::kBudgets, Nanoseconds> budget;
  decltype(TaskFaults::told) told_seen = 0, faults_seen = 0;  ///< FaultRecord::told and count, at the last check
  std::uint32_t dropped = 0;                     ///< releases since the last completed cycle
  bool skip_next = false;                        ///< the reaction `skip`: the next release is dropped
  bool is_on = false;                            ///< the task takes part in releases
  bool is_plain = true;                          ///< no miss is tolerated: a good job in time needs no judgement
  /// Bits set by the thread of the task (fetch_or) and cleared by cycle boundaries (fetch_and). Relaxed, pairs with
  /// nothing: JobThreads::claim orders the data behind the bits, and a cycle boundary calls it before it touches the
  /// task.
  SharedWord<std::uint8_t> left{0};
  /// fetch_or of the reporter (a cycle boundary, the supervisor) pairs with that at the end of the job, both acq_rel:
  /// of a report and the end exactly one sees the other. Cleared before any thread knows of the next job.
  SharedWord<std::uint8_t> reported{0};
  [[no_unique_address]] TaskMisses history;  ///< kept if misses are tolerated

  /// A job may start: its release is not to be skipped, and enough time is left.
  [[gnu::always_inline]] bool lets_start(const Nanoseconds& now, const Nanoseconds& deadline) const noexcept {
    return !mechanisms::kReactions || (!skip_next && now + start_margin <= deadline);
  }
  [[gnu::always_inline]] bool is_within_budget(const Nanoseconds& used) const noexcept {
    return !mechanisms::kBudgets || used <= budget;
  }
};

}  // namespace chimera
