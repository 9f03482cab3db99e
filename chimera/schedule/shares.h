// SPDX-License-Identifier: Apache-2.0
// What units that share a CPU may use of it, where there is a limit for all of them together.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

namespace chimera {

/// A unit as the shares see it.
struct ShareMember {
  std::uint32_t cpu = 0;
  double load = 0;  ///< by the budgets of its tasks
};

/// The share of `members[index]`, so that all on its CPU have `all` together: what its budgets ask for, and of what is
/// left as much as each. Where they ask for more than there is, they get it in proportion. Context: setup; O(members).
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
