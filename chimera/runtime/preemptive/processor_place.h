// SPDX-License-Identifier: Apache-2.0
// The processor of a preemptive context, and counts of events on it.
#pragma once

#include <atomic>
#include <cstdint>

#include "chimera/base/time.h"

namespace chimera {

/// The processor of a preemptive context.
struct ProcessorPlace {
  int cpu = -1;       ///< -1: any (without real-time levels)
  int ceiling = 0;    ///< SCHED_FIFO level of the section; 0: no real-time levels at all
  int base = 0;       ///< of jobs that found no level of their own; labels lie between; ceiling - base >= 2
  Nanoseconds quantum = microseconds(500);  ///< of the laxity policy
  /// Jobs may use `share` of each `window`. Beyond that some are demoted below all others, before the kernel takes the
  /// processor from all of them (sched_rt_runtime_us). kNever: no limit.
  Nanoseconds share = kNever, window = seconds(1);
  bool checks = false;  ///< looks up every level in the kernel at every entry to the section: for tests, costs
  /// Rung when a cycle boundary is due; run() sleeps on it. Null: one of its own.
  std::atomic<std::uint32_t>* bell = nullptr;
};

/// Counts of events of the section and the levels, for tests and figures.
struct ProcessorCounts {
  std::uint64_t jobs = 0;
  std::uint64_t level_changes = 0;
  std::uint64_t preemptions = 0;
  std::uint64_t ended_unseen = 0;   ///< a job was over, and others were released before its thread could say so
  std::uint64_t supervised = 0;     ///< times the alarm rang
  std::uint64_t wrong_levels = 0;   ///< with checks: a job did not run at its label, or labels were out of order
  std::uint64_t checked = 0;        ///< with checks: entries to the section
  /// Times the section was found taken: 0 with real-time levels. With checks: while its holder was awake.
  std::uint64_t section_taken = 0;
  /// With checks: times it was found taken while the kernel had its holder asleep (a page that had to be fetched; a
  /// virtual machine fetches pages from its host).
  std::uint64_t taken_asleep = 0;
};

}  // namespace chimera
