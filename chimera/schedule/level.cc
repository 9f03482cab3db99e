// SPDX-License-Identifier: Apache-2.0
// Checks the processor demand of one level at each of its deadlines within the longest busy period.
#include "chimera/schedule/level.h"

#include "chimera/base/assert.h"

namespace chimera {
namespace {

constexpr Nanoseconds kTick{1};

Nanoseconds later(Nanoseconds a, Nanoseconds b) noexcept { return a < b ? b : a; }

/// QPA: checks intervals from long to short and skips all intervals that cannot fail.
class DemandSearch {
 public:
  DemandSearch(const Level& level, Demand& demand, Effort& effort) noexcept
      : level_(level), demand_(demand), effort_(effort) {
    extra_ = level.order == LevelOrder::kLaxity ? level.quantum * (level.end - level.begin - 1) : Nanoseconds{};
    later_levels_ = blocking_of_later(level);
    for (const RankedWork& r : level.members()) shortest_ = shortest_ < r.work.deadline ? shortest_ : r.work.deadline;
  }

  /// The longest interval to check: if a longer one fails, a shorter one fails too.
  Nanoseconds longest() noexcept { return busy_period(level_, blocking({}) + extra_, effort_); }

  Judgement from(Nanoseconds longest) noexcept {
    for (Nanoseconds t = point_before(longest + kTick); t >= shortest_;) {
      const Nanoseconds ends = end_of(t);
      if (effort_.is_spent()) return Judgement::kGivenUp;
      if (ends > t) {
        demand_ = {t, ends};
        return Judgement::kFails;
      }
      t = point_before(ends);  // in [ends, t) no more is due, and no job blocks: a blocking job is due by t
    }
    return Judgement::kHolds;
  }

 private:
  Nanoseconds point_before(Nanoseconds t) noexcept {
    effort_.terms -= level_.end - level_.begin;
    Nanoseconds point;
    for (const RankedWork& r : level_.members()) {
      const Nanoseconds first = first_due(r);
      if (t > first) point = later(point, r.work.period * ((t - kTick - first) / r.work.period) + first);
    }
    return point;
  }

  Nanoseconds blocking(Nanoseconds t) const noexcept {
    Nanoseconds most = later_levels_;
    if (level_.dispatch == Dispatch::kPreemptive) return most;
    for (const RankedWork& r : level_.members())
      if (r.work.deadline > t) most = later(most, r.work.time - kTick);
    return most;
  }

  Nanoseconds end_of(Nanoseconds t) noexcept {
    effort_.terms -= level_.end - level_.begin;
    Nanoseconds work = blocking(t) + extra_;
    for (const RankedWork& r : level_.members()) work += due(r, t);
    const auto before = level_.before();
    if (before.empty()) return work;
    return least_fixed_point(later(work, kTick), t, level_.begin, effort_,
                             [&](Nanoseconds s) { return work + requested(before, s); });
  }

  const Level& level_;
  Demand& demand_;
  Effort& effort_;
  Nanoseconds extra_, later_levels_;
  Nanoseconds shortest_ = kNever;
};

bool has_server(const Level& level) noexcept {
  for (const RankedWork& r : level.members())
    if (r.work.server) return true;
  return false;
}

}  // namespace

Nanoseconds blocking_of_later(const Level& level) noexcept {
  Nanoseconds most;
  if (level.dispatch == Dispatch::kPreemptive) return most;
  const std::uint32_t rtpu = level.ranked[level.begin].work.rtpu;
  for (const RankedWork& r : level.ranked.subspan(level.end))
    if (r.work.rtpu == rtpu && r.work.time > kTick) most = later(most, r.work.time - kTick);
  return most;
}

Nanoseconds busy_period(const Level& level, Nanoseconds blocking, Effort& effort) noexcept {
  const auto works = level.up_to_here();
  const double share = share_of(works);
  Nanoseconds first = blocking, ahead = blocking;
  for (const RankedWork& r : works) {
    first += r.work.time;
    ahead += r.jitter;
  }
  // A full processor never catches up with earlier work.
  if (share > 1.0 + 1e-12 || (share > 1.0 - 1e-9 && ahead > Nanoseconds{})) return kNever;
  return least_fixed_point(later(first, kTick), kLongestInterval, level.end, effort,
                           [&](Nanoseconds t) { return blocking + requested(works, t); });
}

Judgement demand_holds(const Level& level, Demand& demand, Effort& effort) noexcept {
  CHIMERA_ASSERT(level.order != LevelOrder::kAlone);
  if (level.order == LevelOrder::kLaxity && (level.dispatch == Dispatch::kExecutive || has_server(level)))
    return Judgement::kFails;
  DemandSearch search(level, demand, effort);
  const Nanoseconds longest = search.longest();
  if (longest != kNever) return search.from(longest);
  return effort.is_spent() ? Judgement::kGivenUp : Judgement::kFails;
}

}  // namespace chimera
