// SPDX-License-Identifier: Apache-2.0
// Claims on groups of standbys. If several rtpus find a group without a task that is ON, only the one with the claim
// turns its task ON. DecisionPage::claims; docs/formats/processes.md.
#pragma once

#include <cstddef>
#include <cstdint>

#include "chimera/runtime/hosted/pages.h"

namespace chimera {

/// Claims of one incarnation of an rtpu. Only the cycling thread uses it. Context of all functions: cycle boundary;
/// wait-free.
class GroupClaims {
 public:
  /// Both pages outlive this.
  GroupClaims(DecisionPage& decision, const KeeperPage& keeper, std::uint32_t me, std::uint32_t incarnation) noexcept
      : decision_(decision), keeper_(keeper), mine_((std::uint64_t{me} + 1) << 32 | incarnation) {}

  /// True if this rtpu now has the claim, until give_back(). False if another live rtpu has it or the run ends.
  bool take(std::size_t group) noexcept;
  /// Gives all claims back. Requires: the changes made under them have been published.
  void give_back() noexcept;

 private:
  bool is_held(std::uint64_t claim) const noexcept;

  DecisionPage& decision_;
  const KeeperPage& keeper_;
  std::uint64_t mine_;
  bool has_any_ = false;
};

}  // namespace chimera
