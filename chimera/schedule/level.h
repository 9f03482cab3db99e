// SPDX-License-Identifier: Apache-2.0
// Whether the jobs of one level (analysis.h) keep their deadlines, given all levels before it.
//
// A miss at d needs a busy interval [t0, d] in which nothing but earlier levels, jobs of this level released from t0 on
// and due by d, and one job that could not be taken off the processor at t0 had it. So no job misses if for every
// length t some s <= t has  requested_before(s) + due(t) + blocking(t) <= s; the least such s is `ends` below.
//
// Least laxity, compared at least every quantum q: let slack(d) be what the level still gets until d minus what is due
// by d. A job with a later deadline d' that runs while one due by d waits has slack(d') <= slack(d) + q, so slack(d)
// falls at most q below slack(d'); along a chain of such deadlines, all of distinct tasks, at most (n - 1) q in all.
// Levels with servers, and those of an executive, are judged by their busy period alone.
#pragma once

#include <cstdint>
#include <span>

#include "chimera/schedule/demand.h"

namespace chimera {

/// How jobs of one level are ordered among themselves.
enum class LevelOrder : std::uint8_t { kAlone, kDeadline, kLaxity };

/// Some tasks in a row of those of a CPU, ranked. All of `ranked` before `begin` goes first.
struct Level {
  std::span<const RankedWork> ranked;
  std::uint32_t begin = 0, end = 0;
  LevelOrder order = LevelOrder::kAlone;
  Dispatch dispatch = Dispatch::kPreemptive;
  Nanoseconds quantum;

  std::span<const RankedWork> before() const noexcept { return ranked.first(begin); }
  std::span<const RankedWork> members() const noexcept { return ranked.subspan(begin, end - begin); }
  std::span<const RankedWork> up_to_here() const noexcept { return ranked.first(end); }
};

/// The demand of a level at the interval that decides.
struct Demand {
  Nanoseconds within;  ///< a busy interval of this length; 0: none was found
  Nanoseconds ends;    ///< when its work would be done: later than `within` is a miss
};

/// The longest job of a later level of the same rtpu that can be under way when a job of `level` is released, less the
/// nanosecond that it began before. 0 when it can be taken off. Context: setup; pure.
Nanoseconds blocking_of_later(const Level& level) noexcept;

/// How long the processor can be busy with this level and those before it, from a synchronous release behind
/// `blocking`; kNever when that has no end within reach. No job of the level takes longer. Context: setup; pure.
Nanoseconds busy_period(const Level& level, Nanoseconds blocking, Effort& effort) noexcept;

enum class Judgement : std::uint8_t { kHolds, kFails, kGivenUp };

/// Whether every job of a level ordered by deadline or laxity is done in time. `demand` receives the interval that
/// fails. Context: setup; pure.
Judgement demand_holds(const Level& level, Demand& demand, Effort& effort) noexcept;

}  // namespace chimera
