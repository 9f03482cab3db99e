// SPDX-License-Identifier: Apache-2.0
// Who may turn a task of a group of standbys ON: of several real-time units that find the group without a task that is
// ON, one at a time. DecisionPage::claims; docs/formats/processes.md.
#pragma once

#include <cstddef>
#include <cstdint>

#include "chimera/runtime/hosted/pages.h"

namespace chimera {

/// Of one unit in one incarnation. Used by the thread that cycles only. Context of everything: cycle boundary;
/// wait-free.
class GroupClaims {
 public:
  /// Both pages outlive this.
  GroupClaims(DecisionPage& decision, const KeeperPage& keeper, std::uint32_t me, std::uint32_t incarnation) noexcept
      : decision_(decision), keeper_(keeper), mine_((std::uint64_t{me} + 1) << 32 | incarnation) {}

  /// True: the claim is this unit's until give_back(). False: another unit that lives has it, or the run ends.
  bool take(std::size_t group) noexcept;
  /// All of them: what was done with them has been shown.
  void give_back() noexcept;

 private:
  bool is_held(std::uint64_t claim) const noexcept;

  DecisionPage& decision_;
  const KeeperPage& keeper_;
  std::uint64_t mine_;
  bool has_any_ = false;
};

}  // namespace chimera
