// SPDX-License-Identifier: Apache-2.0
// The manager's own segment: the operator variables, what it posts, and what its successor has to know.
#pragma once

#include <memory>
#include <optional>
#include <vector>

#include "chimera/manager/peers.h"

namespace chimera::manager {

/// Made once by each manager; whatever the predecessor left in its segment is taken over. Context: setup.
class OwnSegment {
 public:
  /// `predecessor` may be null: the first manager. Goals, memory, journal, the operator's flag and variables are
  /// copied from it. `peers` outlives it. Refuses what the system refuses.
  static Result<OwnSegment> make(const Peers& peers, std::uint32_t incarnation, const PeerSegment* predecessor,
                                 Nanoseconds now);

  /// To be passed on.
  int descriptor() const noexcept { return region_.descriptor(); }
  const BlockOwner& block() const noexcept { return block_; }
  std::uint32_t incarnation() const noexcept { return incarnation_; }
  /// Number of this peer.
  std::uint32_t peer() const noexcept { return peer_; }

  GroupReader operator_reader(std::size_t index) const noexcept;
  /// Publishes a value of operator variable `index`: value.size() is that of the variable at its largest.
  void publish_operator(std::size_t index, std::span<const std::byte> value, Nanoseconds now) noexcept;

 private:
  OwnSegment(const PeerLayout& layout, MemoryRegion region, std::uint32_t incarnation) noexcept
      : layout_(&layout), region_(std::move(region)), incarnation_(incarnation) {}
  void take_over(const BlockView& left, const Peers& peers) noexcept;
  Link link(std::size_t index) const noexcept;

  const PeerLayout* layout_;
  MemoryRegion region_;
  BlockOwner block_;
  std::vector<GroupWriter> operators_;
  std::uint32_t incarnation_ = 0;
  std::uint32_t peer_ = 0;
};

}  // namespace chimera::manager
