// SPDX-License-Identifier: Apache-2.0
// What a task costs and how punctual it is, always measured (1994 paper 3.3; reference HASE'96 for the idea).
#pragma once

#include <algorithm>
#include <atomic>
#include <cstdint>

#include "chimera/base/time.h"
#include "chimera/task/abi.h"
#include "chimera/task/signal.h"

namespace chimera {

/// Smallest, largest and sum of a duration. Context: cycle; wait-free.
struct Spread {
  std::uint64_t count = 0;
  Nanoseconds min = kNever;
  Nanoseconds max{INT64_MIN};
  Nanoseconds sum;

  void add(Nanoseconds value) noexcept {
    ++count;
    if (value < min) min = value;
    if (value > max) max = value;
    sum += value;
  }
  /// Mean, 0 when nothing was added.
  Nanoseconds mean() const noexcept { return {count == 0 ? 0 : sum.count / static_cast<std::int64_t>(count)}; }
};

/// Adds to a count that only the calling thread changes, and that count_of() may read meanwhile. Context: cycle;
/// wait-free.
inline void add_to(std::uint64_t& count, std::uint64_t n) noexcept {
  const std::atomic_ref<std::uint64_t> shared(count);
  shared.store(shared.load(std::memory_order_relaxed) + n, std::memory_order_relaxed);
}
inline std::uint64_t count_of(std::uint64_t& count) noexcept {
  return std::atomic_ref<std::uint64_t>(count).load(std::memory_order_relaxed);
}

/// Everything counted about one task. Written by the job step and the executor of its context only.
struct Profile {
  // What every job adds to comes first (Task).
  Spread response;                    ///< release to completion of a cycle
  Spread start_delay;                 ///< release to start of a cycle: its max minus min is the start jitter
  std::uint64_t cycles = 0;           ///< completed (published) cycles since spawn
  std::uint32_t missed_in_a_row = 0;
  // Where they take no room: a job step multiplies by the size of a task. 65535: or more.
  std::uint16_t restarts = 0;         ///< by the reaction `restart` of on_fault
  std::uint16_t takeovers = 0;        ///< times it went ON in place of a task that failed
  /// Time that a method used, both its transfers included; virtual time: modelled.
  Spread execution[CHIMERA_METHODS];
  std::uint64_t aborted = 0;          ///< cycles that gave up
  std::uint64_t partial = 0;          ///< published cycles that gave up with a result of use
  std::uint64_t tolerated = 0;        ///< missed deadlines that called no reaction, as `tolerate` allows
  std::uint64_t held = 0;             ///< late cycles not published (on_miss: hold)
  std::uint64_t missed = 0;           ///< deadlines: cycles that ended late, and releases dropped for lack of time
  std::uint64_t overrun = 0;          ///< cycles that used more than their budget
  std::uint64_t min_refused = 0;      ///< cycles whose minimum time could no longer be granted
  std::uint64_t dropped = 0;          ///< releases dropped
  std::uint64_t stale = 0;            ///< inputs kept because a read was overtaken
  std::uint64_t rejected = 0;         ///< outputs of safety ports refused: NaN, infinite or out of range
  std::uint64_t preempted = 0;        ///< times a more urgent job took the processor
  std::uint64_t demoted = 0;          ///< jobs that went on below all others
  std::uint64_t events = 0;           ///< behind a server: that came while it was ON
  std::uint64_t events_lost = 0;      ///< behind a server: that came while it was not, or waited when it ceased to be;
                                      ///< of any task: that it sent and that found no room on the way to another rtpu
  std::uint64_t exhausted = 0;        ///< times its server ran out of capacity in the middle of a job
  Nanoseconds on_since = kNever;      ///< kNever: it is not ON
  Nanoseconds on_before;              ///< time that it was ON until then
  Nanoseconds late[3];                ///< what of_late() answers of reinit, on and off

  /// How long the method takes of late, as a gap for it must be: of reinit, on and off the longest call, of which every
  /// later call forgets half, so that one that was held up once does not count for ever; of others the longest ever.
  /// Requires: it was called. Context: any; wait-free.
  Nanoseconds of_late(Method method) const noexcept {
    const Nanoseconds longest = execution[static_cast<int>(method)].max;
    const int place = late_place(method);
    return place < 0 ? longest : late[place];
  }
  /// Adds a call of a method by an edge. Context: edge; wait-free.
  void add_call(Method method, Nanoseconds used) noexcept {
    execution[static_cast<int>(method)].add(used);
    const int place = late_place(method);
    if (place >= 0) late[place] = std::max(used, Nanoseconds{late[place].count / 2});
  }
  static constexpr int late_place(Method method) noexcept {
    return method == Method::kReinit ? 0 : method == Method::kOn ? 1 : method == Method::kOff ? 2 : -1;
  }

  /// Time that it was ON by `now`. Context: any; wait-free.
  Nanoseconds on_by(Nanoseconds now) const noexcept {
    return on_since == kNever ? on_before : on_before + (now - on_since);
  }
};

}  // namespace chimera
