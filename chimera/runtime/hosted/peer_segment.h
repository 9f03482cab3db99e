// SPDX-License-Identifier: Apache-2.0
// The shared-memory segment of another process, mapped read-only: the groups of its tasks and its block.
// docs/formats/processes.md.
#pragma once

#include <cstdint>

#include "chimera/base/result.h"
#include "chimera/platform/shared_memory.h"
#include "chimera/runtime/hosted/rtpu_block.h"
#include "chimera/runtime/state/peer_layout.h"
#include "chimera/table/group.h"

namespace chimera {

/// One incarnation of a peer, checked and mapped. Empty until assigned. Move-only.
class PeerSegment {
 public:
  PeerSegment() noexcept = default;
  /// Maps the memory behind `descriptor`, which stays the caller's. Refuses what is not the segment of that
  /// incarnation of peer number `peer`, laid out as `layout` (which outlives this). Context: setup; may block.
  static Result<PeerSegment> open(int descriptor, const PeerLayout& layout, std::uint32_t n_tasks, std::uint32_t peer,
                                  std::uint32_t incarnation);

  /// False for an empty one. Context: any; wait-free, as everything below.
  bool is_there() const noexcept { return block_.is_there(); }
  /// Refuses a segment whose headers are not those of open(): its owner has overwritten them. Requires: is_there().
  Result<void> check() const;
  const BlockView& block() const noexcept { return block_; }
  std::uint32_t incarnation() const noexcept { return incarnation_; }
  /// Requires: is_there(), and that `id` is a group of the layout.
  GroupReader group(GroupId id) const noexcept;

 private:
  MemoryRegion region_;
  BlockView block_;
  const PeerLayout* layout_ = nullptr;
  std::uint32_t incarnation_ = 0, peer_ = 0, n_tasks_ = 0;
};

}  // namespace chimera
