// SPDX-License-Identifier: Apache-2.0
// The segments of the other peers as one real-time unit maps them. The process's main thread offers new ones, the
// thread that cycles adopts them at an edge; what it let go is unmapped by the main thread again.
#pragma once

#include <atomic>
#include <cstdint>
#include <memory>
#include <vector>

#include "chimera/base/result.h"
#include "chimera/platform/memory_region.h"
#include "chimera/runtime/peer_layout.h"
#include "chimera/runtime/rtpu_block.h"

namespace chimera {

/// One incarnation of a peer, mapped read-only.
struct MappedPeer {
  MemoryRegion region;
  std::uint32_t incarnation = 0;
  BlockView block;
  MappedPeer* next = nullptr;  ///< in the list of those let go

  const std::byte* groups() const noexcept { return region.bytes().data() + sizeof(SegmentHeader); }
};

/// Owns all mappings. Peer numbers as in docs/formats/processes.md.
class Peers {
 public:
  /// Computes the layouts of all peers. Context: setup.
  static Result<std::unique_ptr<Peers>> create(const ApplicationSpec& spec);
  Peers(const Peers&) = delete;
  Peers& operator=(const Peers&) = delete;
  ~Peers();

  std::uint32_t count() const noexcept { return static_cast<std::uint32_t>(slots_.size()); }
  const PeerLayout& layout(std::uint32_t peer) const noexcept { return *layouts_[peer]; }

  /// Maps a segment and checks that it is what the application says; adopted at the next edge. Refuses strangers.
  /// Context: main thread; may block.
  Result<void> offer(std::uint32_t peer, std::uint32_t incarnation, int descriptor);
  /// Unmaps what was let go. Context: main thread; may block.
  void clear();

  /// Takes over a segment that was offered; true when there is a new one. The one before stays mapped until let_go().
  /// Context: edge; wait-free.
  bool adopt(std::uint32_t peer) noexcept;
  /// Nothing reads the predecessor of the adopted segment any more. Context: edge; wait-free.
  void let_go(std::uint32_t peer) noexcept;
  /// The adopted segment; nullptr: none yet. Context: edge; wait-free.
  const MappedPeer* at(std::uint32_t peer) const noexcept { return slots_[peer]->present; }

 private:
  struct Slot {
    std::atomic<MappedPeer*> offered{nullptr};
    MappedPeer* present = nullptr;
    MappedPeer* previous = nullptr;
  };

  Peers() = default;
  const ApplicationSpec* spec_ = nullptr;
  std::vector<std::unique_ptr<PeerLayout>> layouts_;
  std::vector<std::unique_ptr<Slot>> slots_;
  std::atomic<MappedPeer*> released_{nullptr};
};

}  // namespace chimera
