// SPDX-License-Identifier: Apache-2.0
// Bands of SCHED_FIFO priorities. Rtpus that share a CPU get one band each, ordered by their most critical task. Ties
// keep the order of the description.
#pragma once

#include <cstdint>
#include <span>

namespace chimera {

inline constexpr std::int32_t kBandWidth = 20;  ///< priorities of one band
inline constexpr std::int32_t kLowestBandTop = 1;

/// The data of an rtpu that decide its band.
struct BandMember {
  std::uint32_t cpu = 0;
  std::uint32_t criticality = 0;  ///< of its most critical task
};

/// The highest priority of the band of `members[index]`, counted down from `top`; at least 1. 0 if `top` is 0, for a
/// system without real-time priorities. Context: setup; O(members).
constexpr std::int32_t band_top(std::span<const BandMember> members, std::size_t index, std::int32_t top) noexcept {
  if (top <= 0) return 0;
  std::int32_t above = 0;
  for (std::size_t i = 0; i < members.size(); ++i) {
    if (i == index || members[i].cpu != members[index].cpu) continue;
    const bool more = members[i].criticality > members[index].criticality;
    const bool same = members[i].criticality == members[index].criticality && i < index;
    if (more || same) ++above;
  }
  const std::int32_t priority = top - above * kBandWidth;
  return priority < kLowestBandTop ? kLowestBandTop : priority;
}

}  // namespace chimera
