// SPDX-License-Identifier: Apache-2.0
// The manager's own segment: the operator variables, its posts, and the data that its successor needs.
#pragma once

#include <memory>
#include <optional>
#include <vector>

#include "chimera/manager/state/peers.h"

namespace chimera::manager {

/// Each manager makes one. It takes over the data that the predecessor left in its segment. Context: setup.
class OwnSegment {
 public:
  /// `predecessor` is null for the first manager. Copies goals, memory, journal, the operator's flag and variables from
  /// it. `peers` outlives it. Refuses if the system refuses the memory.
  static Result<OwnSegment> make(const Peers& peers, std::uint32_t incarnation, const PeerSegment* predecessor,
                                 Nanoseconds now);

  /// Descriptor of the segment, for other processes.
  int descriptor() const noexcept { return region_.descriptor(); }
  const BlockOwner& block() const noexcept { return block_; }
  std::uint32_t incarnation() const noexcept { return incarnation_; }
  /// Number of this peer.
  std::uint32_t peer() const noexcept { return peer_; }

  GroupReader operator_reader(std::size_t index) const noexcept;
  /// Publishes a value of operator variable `index`. value.size() is the largest size of the variable.
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
