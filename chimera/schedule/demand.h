// SPDX-License-Identifier: Apache-2.0
// Bounds the work of tasks in an interval. The analysis is based on these two functions, and on the search for the end
// of a busy period.
//   request bound   all jobs released in an interval of length t: ceil((t + J) / T) C  (Joseph & Pandya 1986; release
//                   jitter J: Audsley et al. 1993)
//   demand bound    jobs released and due in it: (floor((t - D) / T) + 1) C  (Baruah, Rosier, Howell 1990)
// A deferrable server may run at the end of one period and at the start of the next: J = T - C. In the demand its
// capacity is due as early as it can be used, D = C. (If part of it is due earlier, others still have
// as much time as with D = C.)
#pragma once

#include <cstdint>
#include <span>

#include "chimera/schedule/work.h"

namespace chimera {

/// A task in the order of levels; memory of the analysis.
struct RankedWork {
  Work work;
  std::uint32_t task = 0;   ///< index in the set
  std::uint32_t band = 0;   ///< of its rtpu on this CPU; 0 runs first
  Nanoseconds jitter;       ///< release jitter
  Nanoseconds early;        ///< deferrable server: capacity that can be due as early as it can be used
  std::uint64_t tie = 0;    ///< tie_of()
};

/// Searches end here (11 days); no longer interval matters.
inline constexpr Nanoseconds kLongestInterval{1'000'000'000'000'000};

/// The number of terms that a search may still add. It ends searches that would not end near a full processor.
struct Effort {
  std::int64_t terms = 0;
  bool is_spent() const noexcept { return terms <= 0; }
};

/// Work released in [0, t), with all tasks released together at 0. Requires: t > 0. Context: any; pure.
constexpr Nanoseconds requested(const RankedWork& r, Nanoseconds t) noexcept {
  return r.work.time * ((t + r.jitter - Nanoseconds{1}) / r.work.period + 1);
}

/// Work released in [0, t], the instant t included. Requires: t >= 0. Context: any; pure.
constexpr Nanoseconds requested_until(const RankedWork& r, Nanoseconds t) noexcept {
  return r.work.time * ((t + r.jitter) / r.work.period + 1);
}

/// The first t at which a whole job can be due; one more job is due each period. Context: any; pure.
constexpr Nanoseconds first_due(const RankedWork& r) noexcept {
  return r.work.server == ServerKind::kDeferrable ? r.early : r.work.deadline;
}

/// Work released and due in [0, t]. Requires: t >= 0. Context: any; pure.
constexpr Nanoseconds due(const RankedWork& r, Nanoseconds t) noexcept {
  return t < first_due(r) ? Nanoseconds{} : r.work.time * ((t - first_due(r)) / r.work.period + 1);
}

/// The sum of `requested` over `works`. Context: any; pure.
inline Nanoseconds requested(std::span<const RankedWork> works, Nanoseconds t) noexcept {
  Nanoseconds sum;
  for (const RankedWork& r : works) sum += requested(r, t);
  return sum;
}

/// The sum of budgets over periods. Context: any; pure.
inline double share_of(std::span<const RankedWork> works) noexcept {
  double sum = 0;
  for (const RankedWork& r : works)
    sum += static_cast<double>(r.work.time.count) / static_cast<double>(r.work.period.count);
  return sum;
}

/// The least t >= `from` with f(t) <= t, for a function f that never falls. kNever if it is beyond `limit`, or if
/// `effort` is spent; each try costs `cost`. Context: any; pure.
template <class F>
Nanoseconds least_fixed_point(Nanoseconds from, Nanoseconds limit, std::int64_t cost, Effort& effort, F f) noexcept {
  for (Nanoseconds t = from; t <= limit && !effort.is_spent();) {
    effort.terms -= cost;
    const Nanoseconds next = f(t);
    if (next <= t) return t;
    t = next;
  }
  return kNever;
}

}  // namespace chimera
