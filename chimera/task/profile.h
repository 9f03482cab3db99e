// SPDX-License-Identifier: Apache-2.0
// Measures the cost and the punctuality of a task, always (1994 paper 3.3; reference HASE'96 for the idea).
#pragma once

#include <algorithm>
#include <atomic>
#include <compare>
#include <cstdint>
#include <type_traits>

#include "chimera/base/mechanisms.h"
#include "chimera/base/time.h"
#include "chimera/task/abi.h"
#include "chimera/task/signal.h"

namespace chimera {

/// A count of the run: 32 bits where the target has no more.
using Count = std::conditional_t<mechanisms::kCopies, std::uint64_t, std::uint32_t>;

/// A duration of 0 to 4.29 s in 32 bits, for a profile; a longer one counts as the longest. Context: any; wait-free.
struct ShortTime {
  std::uint32_t count = 0;

  constexpr explicit ShortTime(std::uint32_t ns) noexcept : count(ns) {}
  constexpr explicit ShortTime(Nanoseconds time) noexcept
      : count(time.count < 0 ? 0 : time.count > UINT32_MAX ? UINT32_MAX : static_cast<std::uint32_t>(time.count)) {}
  constexpr operator Nanoseconds() const noexcept { return {count}; }
  constexpr auto operator<=>(const ShortTime&) const noexcept = default;
};

/// Smallest, largest and sum of a duration. Context: cycle; wait-free.
struct LongSpread {
  Count count = 0;
  Nanoseconds min = kNever;
  Nanoseconds max{INT64_MIN};
  Nanoseconds sum;

  void add(Nanoseconds value) noexcept {
    ++count;
    if (value < min) min = value;
    if (value > max) max = value;
    sum += value;
  }
  /// The mean; 0 if no value was added.
  Nanoseconds mean() const noexcept { return {count == 0 ? 0 : sum.count / static_cast<std::int64_t>(count)}; }
};

/// As LongSpread, for images. Requires: values of 0 or more. Context: cycle; wait-free.
struct ShortSpread {
  Nanoseconds sum;
  Count count = 0;
  ShortTime min{UINT32_MAX}, max{std::uint32_t{0}};

  void add(Nanoseconds value) noexcept {
    const std::uint32_t ns = ShortTime(value).count;
    ++count;
    if (ns < min.count) min.count = ns;
    if (ns > max.count) max.count = ns;
    sum += value;
  }
  /// The mean; 0 if no value was added.
  Nanoseconds mean() const noexcept { return {count == 0 ? 0 : sum.count / static_cast<std::int64_t>(count)}; }
};
using Spread = std::conditional_t<mechanisms::kCopies, LongSpread, ShortSpread>;

/// Execution times of cycle, and of all other methods together.
struct CycleSpread {
  Spread cycle, others;

  constexpr Spread& operator[](int method) noexcept { return method == CHIMERA_CYCLE ? cycle : others; }
  constexpr const Spread& operator[](int method) const noexcept { return method == CHIMERA_CYCLE ? cycle : others; }
};
inline constexpr bool kMethodsAreTimed = mechanisms::kCopies || mechanisms::kSwitch;
using MethodSpreads = std::conditional_t<kMethodsAreTimed, Spread[CHIMERA_METHODS], CycleSpread>;

/// Adds to a count that only the calling thread changes, while count_of() may read it. Context: cycle; wait-free.
inline void add_to(Count& count, Count n) noexcept {
  const std::atomic_ref<Count> shared(count);
  shared.store(shared.load(std::memory_order_relaxed) + n, std::memory_order_relaxed);
}
inline std::uint64_t count_of(Count& count) noexcept {
  return std::atomic_ref<Count>(count).load(std::memory_order_relaxed);
}

/// All counts about one task. Only the job step and the executor of its context write it.
struct Profile {
  // The members that every job adds to come first (Task).
  Spread response;                    ///< release to completion of a cycle
  Spread start_delay;                 ///< release to start of a cycle: its max minus min is the start jitter
  Count cycles = 0;           ///< completed (published) cycles since spawn
  std::uint32_t missed_in_a_row = 0;
  // These members fill a gap, because a job step multiplies by the size of a task. 65535: or more.
  std::uint16_t restarts = 0;         ///< by the reaction `restart` of on_fault
  std::uint16_t takeovers = 0;        ///< number of times that it replaced a failed task
  /// Execution time of a method, with both its transfers; in virtual time the modelled time.
  MethodSpreads execution;
  Count aborted = 0;          ///< cycles that gave up
  Count partial = 0;          ///< published cycles that gave up with a useful result
  Count tolerated = 0;        ///< missed deadlines without a reaction, as `tolerate` allows
  Count held = 0;             ///< late cycles not published (on_miss: hold)
  Count missed = 0;           ///< deadlines: cycles that ended late, releases dropped for lack of time
  Count overrun = 0;          ///< cycles that used more than their budget
  Count min_refused = 0;      ///< cycles whose minimum time was no longer available
  Count dropped = 0;          ///< releases dropped
  Count stale = 0;            ///< inputs that kept their old value because a read was overtaken
  Count rejected = 0;         ///< outputs that a safety port refused: NaN, infinite or out of range
  Count preempted = 0;        ///< number of times that a more urgent job took the processor
  Count demoted = 0;          ///< jobs that continued below all real-time threads
  Count events = 0;           ///< that came while the task was ON
  Count events_lost = 0;      ///< events while it was not ON, or waiting when it went OFF;
                                      ///< any task: events it sent without room on the way to another rtpu
  Count exhausted = 0;        ///< number of times that its server ran out of capacity during a job
  Nanoseconds on_since = kNever;      ///< kNever: not ON
  Nanoseconds on_before;              ///< time ON before on_since
  Nanoseconds late[kMethodsAreTimed ? 3 : 1];  ///< the results of of_late() for reinit, on and off

  /// The recent time of a method: the length of a gap for it. For reinit, on and off it is the longest call, halved at
  /// each later call, so that one delayed call does not count for ever. For other methods it is the longest call ever.
  /// Requires: the method was called. Context: any; wait-free.
  Nanoseconds of_late(Method method) const noexcept {
    const Nanoseconds longest = execution[static_cast<int>(method)].max;
    const int place = late_place(method);
    return place < 0 ? longest : late[place];
  }
  /// Adds a call of a method at a cycle boundary. Context: cycle boundary; wait-free.
  void add_call(Method method, Nanoseconds used) noexcept {
    execution[static_cast<int>(method)].add(used);
    const int place = late_place(method);
    if (place >= 0) late[place] = std::max(used, Nanoseconds{late[place].count / 2});
  }
  static constexpr int late_place(Method method) noexcept {
    if constexpr (!kMethodsAreTimed) return -1;
    return method == Method::kReinit ? 0 : method == Method::kOn ? 1 : method == Method::kOff ? 2 : -1;
  }

  /// Total time ON up to `now`. Context: any; wait-free.
  Nanoseconds on_by(Nanoseconds now) const noexcept {
    return on_since == kNever ? on_before : on_before + (now - on_since);
  }
};

}  // namespace chimera
