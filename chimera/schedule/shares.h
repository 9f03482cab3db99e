// SPDX-License-Identifier: Apache-2.0
// Divides a CPU among rtpus that share it, if one limit applies to all of them together.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

namespace chimera {

/// The data of an rtpu that decide its share.
struct ShareMember {
  std::uint32_t cpu = 0;
  double load = 0;  ///< sum over its tasks: budget / period
};

/// The share of `members[index]`, so that all members on its CPU have `all` together. Each gets the load of its budgets
/// and an equal part of the rest. If the loads exceed `all`, each gets its proportion. Context: setup; O(members).
constexpr double share_of(std::span<const ShareMember> members, std::size_t index, double all) noexcept {
  double load = 0, n = 0;
  for (const ShareMember& member : members) {
    if (member.cpu != members[index].cpu) continue;
    load += member.load;
    n += 1;
  }
  const double own = members[index].load;
  return load > all ? own * all / load : own + (all - load) / n;
}

}  // namespace chimera
