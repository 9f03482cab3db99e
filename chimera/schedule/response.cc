// SPDX-License-Identifier: Apache-2.0
// Iterates the response time equations of fixed priorities to their fixed point, preemptive and in an executive.
#include "chimera/schedule/response.h"

namespace chimera {
namespace {

Nanoseconds requested_until(std::span<const RankedWork> works, Nanoseconds t) noexcept {
  Nanoseconds sum;
  for (const RankedWork& r : works) sum += requested_until(r, t);
  return sum;
}

}  // namespace

Response preemptive_response(const Level& level, Effort& effort) noexcept {
  const Work& w = level.ranked[level.begin].work;
  return {least_fixed_point(w.time, w.period, level.end, effort,
                            [&](Nanoseconds t) { return w.time + requested(level.before(), t); }),
          {}};
}

Response executive_response(const Level& level, Effort& effort) noexcept {
  const RankedWork& me = level.ranked[level.begin];
  const Work& w = me.work;
  std::uint32_t bands_end = 0;  // the rtpus before it preempt this whole rtpu
  while (level.ranked[bands_end].band != me.band) ++bands_end;
  const auto bands = level.ranked.first(bands_end);
  const auto earlier = level.ranked.subspan(bands_end, level.begin - bands_end);
  Response response{{}, blocking_of_later(level)};
  const Nanoseconds busy = busy_period(level, response.blocking, effort);
  if (busy == kNever) return {kNever, response.blocking};
  const std::int64_t cost = level.begin + 1;
  Nanoseconds start;
  for (std::int64_t job = 0; w.period * job < busy + me.jitter; ++job) {
    const Nanoseconds mine = response.blocking + w.time * job;
    start = least_fixed_point(start, kLongestInterval, cost, effort, [&](Nanoseconds t) {
      return mine + requested_until(level.before(), t);
    });
    if (start == kNever) return {kNever, response.blocking};
    const Nanoseconds done = mine + w.time + requested_until(earlier, start);
    const Nanoseconds end = least_fixed_point(done, kLongestInterval, cost, effort,
                                              [&](Nanoseconds t) { return done + requested(bands, t); });
    if (end == kNever) return {kNever, response.blocking};
    const Nanoseconds took = end - w.period * job + me.jitter;
    if (took > response.most) response.most = took;
  }
  return response;
}

}  // namespace chimera
