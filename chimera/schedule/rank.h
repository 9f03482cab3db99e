// SPDX-License-Identifier: Apache-2.0
// Ranks a task among those of its CPU, by the band of its rtpu and by its policy. The analyses of a set and of a
// transition share these functions.
#pragma once

#include <algorithm>
#include <cstdint>
#include <span>

#include "chimera/schedule/level.h"
#include "chimera/schedule/work.h"

namespace chimera {

/// The order of tasks within a level under `policy`. Context: any; pure.
constexpr LevelOrder order_of(Policy policy) noexcept {
  if (policy == Policy::kRm) return LevelOrder::kAlone;
  return policy == Policy::kEdf || policy == Policy::kMuf ? LevelOrder::kDeadline : LevelOrder::kLaxity;
}

/// Number of rtpus on this CPU with a higher band than `index`. Context: setup; pure.
constexpr std::uint32_t band_of(std::span<const ProcessorUse> uses, std::uint32_t index) noexcept {
  std::uint32_t above = 0;
  for (std::uint32_t i = 0; i < uses.size(); ++i) {
    if (i == index || uses[i].cpu != uses[index].cpu) continue;
    const bool same = uses[i].criticality == uses[index].criticality;
    if (uses[i].criticality > uses[index].criticality || (same && i < index)) ++above;
  }
  return above;
}

/// works[task] in the form of the analysis. Context: setup; pure.
constexpr RankedWork ranked_work(std::span<const Work> works, std::span<const ProcessorUse> uses,
                                 std::uint32_t task) noexcept {
  RankedWork made{works[task], task, band_of(uses, works[task].rtpu), {}, {}, tie_of(works[task].place, task)};
  Work& w = made.work;
  w.time = std::min(w.time, w.period);  // a longer time does not fit anyway, and sums must not overflow
  if (w.server != ServerKind::kDeferrable) return made;
  // In an executive, a job that begins just before the end of a period continues in the next period.
  const bool preemptive = uses[w.rtpu].dispatch == Dispatch::kPreemptive;
  made.early = preemptive ? w.time : Nanoseconds{};
  made.jitter = w.period - (preemptive ? w.time : Nanoseconds{1});
  return made;
}

}  // namespace chimera
