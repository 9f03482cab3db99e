// SPDX-License-Identifier: Apache-2.0
// Tests if the jobs of one level (analysis.h) meet their deadlines, given all earlier levels.
//
// A miss at d needs a busy interval [t0, d]. Only three kinds of jobs run in it: earlier levels, jobs of this level
// released from t0 on and due by d, and one job that could not be preempted at t0. So no job misses if for every length
// t some s <= t has requested_before(s) + due(t) + blocking(t) <= s. The least such s is `ends` below.
//
// Least laxity, with comparisons at least every quantum q: slack(d) is the time that the level still gets until d,
// minus the work due by d. A job with a later deadline d' that runs while a job due by d waits has slack(d') <=
// slack(d) + q. So slack(d) falls at most q below slack(d'). Along a chain of such deadlines, all of distinct tasks, it
// falls at most (n - 1) q. Levels with servers, and levels of an executive, are judged only by their busy period.
#pragma once

#include <cstdint>
#include <span>

#include "chimera/schedule/demand.h"

namespace chimera {

/// The order of the jobs within one level.
enum class LevelOrder : std::uint8_t { kAlone, kDeadline, kLaxity };

/// Adjacent tasks in the ranking of a CPU. All tasks of `ranked` before `begin` run first.
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

/// The demand of a level in the deciding interval.
struct Demand {
  Nanoseconds within;  ///< length of a busy interval; 0: none was found
  Nanoseconds ends;    ///< end of its work: a miss if later than `within`
};

/// The longest job of a later level of the same rtpu that may run when a job of `level` is released. One nanosecond
/// less, because that job began before. 0 if it can be preempted. Context: setup; pure.
Nanoseconds blocking_of_later(const Level& level) noexcept;

/// The longest time that the processor can be busy with this level and earlier levels, from a synchronous release
/// behind `blocking`. kNever if no end is found. No job of the level takes longer. Context: setup; pure.
Nanoseconds busy_period(const Level& level, Nanoseconds blocking, Effort& effort) noexcept;

enum class Judgement : std::uint8_t { kHolds, kFails, kGivenUp };

/// Judges if every job of a level ordered by deadline or laxity ends in time. `demand` receives the interval that
/// fails. Context: setup; pure.
Judgement demand_holds(const Level& level, Demand& demand, Effort& effort) noexcept;

}  // namespace chimera
