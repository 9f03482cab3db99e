// SPDX-License-Identifier: Apache-2.0
// The segments of the other peers as one real-time unit maps them. The process's main thread offers new ones, the
// thread that cycles takes them at a cycle boundary; the main thread unmaps those that are no longer read.
#pragma once

#include <atomic>
#include <cstdint>
#include <memory>
#include <vector>

#include "chimera/base/result.h"
#include "chimera/runtime/hosted/heap_memory.h"
#include "chimera/runtime/hosted/peer_segment.h"

namespace chimera {

/// Owns all mappings. Peer numbers as in docs/formats/processes.md.
class MappedPeers {
 public:
  /// Computes the layouts of all peers. Context: setup.
  static Result<std::unique_ptr<MappedPeers>> create(const ApplicationSpec& spec);
  MappedPeers(const MappedPeers&) = delete;
  MappedPeers& operator=(const MappedPeers&) = delete;
  ~MappedPeers();

  std::uint32_t count() const noexcept { return static_cast<std::uint32_t>(slots_.size()); }
  const PeerLayout& layout(std::uint32_t peer) const noexcept { return layouts_[peer]; }

  /// Maps a segment and checks that it is what the application says; adopted at the next edge. Refuses strangers.
  /// Context: main thread; may block.
  Result<void> offer(std::uint32_t peer, std::uint32_t incarnation, int descriptor);
  /// Unmaps what was let go. Context: main thread; may block.
  void clear();

  /// Takes over a segment that was offered; true when there is a new one. The one before stays mapped until
  /// release_mapping().
  /// Context: cycle boundary; wait-free.
  bool adopt(std::uint32_t peer) noexcept;
  /// Nothing reads the predecessor of the adopted segment any more. Context: cycle boundary; wait-free.
  void release_mapping(std::uint32_t peer) noexcept;
  /// The adopted segment; nullptr: none yet. Context: cycle boundary; wait-free.
  const PeerSegment* at(std::uint32_t peer) const noexcept {
    const Mapping* present = slots_[peer]->present;
    return present == nullptr ? nullptr : &present->segment;
  }

 private:
  struct Mapping {
    PeerSegment segment;
    Mapping* next = nullptr;  // in the list of those let go
  };
  struct Slot {
    // SYNC: offer() (main thread) releases a mapping that is whole; adopt() (thread that cycles) acquires it.
    std::atomic<Mapping*> offered{nullptr};
    Mapping* present = nullptr;   // by the thread that cycles
    Mapping* previous = nullptr;  // by the thread that cycles
  };

  MappedPeers() = default;
  const ApplicationSpec* spec_ = nullptr;
  HeapMemory memory_;  // behind the layouts
  std::vector<PeerLayout> layouts_;
  std::vector<std::unique_ptr<Slot>> slots_;
  // SYNC: release_mapping() (thread that cycles) releases the list; clear() (main thread) acquires it and unmaps.
  std::atomic<Mapping*> released_{nullptr};
};

}  // namespace chimera
