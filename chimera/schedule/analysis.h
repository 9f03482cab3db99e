// SPDX-License-Identifier: Apache-2.0
// Tests if a set of tasks meets every deadline while all tasks keep their stated times. Pure functions over plain
// specs.
//
// The tasks of a CPU form *levels*: all jobs of a level run before those of later levels. A task under `rm` is a level
// of its own. All tasks of an rtpu under `edf` or `llf` are one level. Under `muf` each criticality is one level.
// Higher bands come first. The test of each level:
//   fixed priority, preemptive   exact response times (Joseph & Pandya, Computer J. 29(5), 1986; Audsley et al.,
//                                Software Eng. J. 8(5), 1993)
//   fixed priority, executive    response over all jobs of the busy period behind the longest later job (George,
//                                Rivierre, Spuri, INRIA RR-2966, 1996; Davis et al., Real-Time Systems 35(3), 2007)
//   earliest deadline            processor demand (Baruah, Rosier, Howell, Real-Time Systems 2(4), 1990) by QPA
//                                (Zhang & Burns, IEEE Trans. Computers 58(9), 2009), here against what higher levels
//                                leave; executive: plus the longest job with a later deadline (Jeffay, Stanat,
//                                Martel, RTSS 1991)
//   least laxity                 the same demand, plus (n - 1) quanta in a level of n tasks: level.h
//   any of them                  a level's busy period bounds the response of all its jobs
// Deferrable servers count as tasks with release jitter period - capacity (Bernat & Burns, RTSS 1999), sporadic ones
// as tasks.
#pragma once

#include <cstdint>
#include <span>

#include "chimera/schedule/level.h"
#include "chimera/schedule/work.h"

namespace chimera {

enum class Guarantee : std::uint8_t {
  kYes,
  kNo,
  kNotStated,  ///< the task has no stated time and counts as zero
  kTooLong,    ///< the search stopped: the load is too close to the whole processor
};

struct WorkVerdict {
  Guarantee guarantee = Guarantee::kNotStated;
  Nanoseconds response = kNever;  ///< upper bound; kNever: no bound was found
  bool is_exact = false;          ///< a synchronous release reaches `response`
  Nanoseconds blocking;           ///< part of the response: a job of a later level that cannot be preempted
  std::uint32_t level = 0;        ///< 0 runs first
};

struct CpuVerdict {
  std::uint32_t cpu = 0;
  std::uint32_t tasks = 0;
  std::uint32_t unstated = 0;      ///< tasks without a time
  double utilisation = 0;          ///< of the tasks with a stated time
  double rate_monotonic_bound = 0;  ///< n(2^(1/n) - 1): Liu & Layland, J. ACM 20(1), 1973
  double hyperbolic = 0;  ///< product of (1 + u); at most 2 is enough: Bini & Buttazzo, IEEE Trans. Comp. 52(7), 2003
  std::uint32_t guaranteed = 0;
  std::uint32_t not_guaranteed = 0;  ///< kNo and kTooLong
  std::int64_t terms = 0;          ///< cost of the searches: number of added terms
  Demand demand;                   ///< the first level that fails

  /// True if every task with a stated time meets its deadline.
  bool fits() const noexcept { return not_guaranteed == 0; }
};

/// Judges the tasks of `works` that run on `cpu`. `verdicts` is as long as `works`; only entries of this CPU are
/// written. `room` needs one element for each of these tasks. Requires: the conditions of Work and ProcessorUse.
/// Context: setup; pure; well below 1 s for a thousand tasks.
CpuVerdict analyse(std::span<const Work> works, std::span<const ProcessorUse> uses, std::uint32_t cpu,
                   std::span<WorkVerdict> verdicts, std::span<RankedWork> room) noexcept;

}  // namespace chimera
