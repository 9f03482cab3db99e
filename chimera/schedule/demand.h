// SPDX-License-Identifier: Apache-2.0
// How much work tasks can ask for in an interval: the two functions on which all of the analysis stands, and the search
// for the instant at which a busy processor is done.
//   request bound   all jobs released in an interval of length t: ceil((t + J) / T) C  (Joseph & Pandya 1986; release
//                   jitter J: Audsley et al. 1993)
//   demand bound    jobs released and due in it: (floor((t - D) / T) + 1) C  (Baruah, Rosier, Howell 1990)
// A deferrable server may run at the end of one period and at the start of the next: J = T - C, and in the demand its
// capacity is due as fast as it can be used, D = C. (What of it is due earlier leaves others as much time as at C.)
#pragma once

#include <cstdint>
#include <span>

#include "chimera/schedule/work.h"

namespace chimera {

/// A task in the order of levels; memory of the analysis.
struct RankedWork {
  Work work;
  std::uint32_t task = 0;   ///< index in the set
  std::uint32_t band = 0;   ///< of its rtpu on this CPU; 0 goes first
  Nanoseconds jitter;       ///< release jitter
  Nanoseconds early;        ///< deferrable server: capacity that can be due as fast as it can be used
};

/// Searches end here: no interval that matters is longer (11 days).
inline constexpr Nanoseconds kLongestInterval{1'000'000'000'000'000};

/// What a search may still spend: terms added up. Ends searches that a load near the whole processor makes endless.
struct Effort {
  std::int64_t terms = 0;
  bool is_spent() const noexcept { return terms <= 0; }
};

/// Work released in [0, t), all of it at once from 0 on. Requires: t > 0. Context: any; pure.
constexpr Nanoseconds requested(const RankedWork& r, Nanoseconds t) noexcept {
  return r.work.time * ((t + r.jitter - Nanoseconds{1}) / r.work.period + 1);
}

/// Work released in [0, t], the instant t included. Requires: t >= 0. Context: any; pure.
constexpr Nanoseconds requested_until(const RankedWork& r, Nanoseconds t) noexcept {
  return r.work.time * ((t + r.jitter) / r.work.period + 1);
}

/// The first t at which all of a job can be due; more every period. Context: any; pure.
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

/// The least t >= `from` with f(t) <= t, for f that never falls; kNever when it is beyond `limit` or `effort`, of which
/// each try takes `cost`, is spent. Context: any; pure.
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
