// SPDX-License-Identifier: Apache-2.0
// The segments of the other peers as one rtpu maps them. The main thread of the process offers new segments; the
// cycling thread adopts them at a cycle boundary. The main thread unmaps segments that are no longer read.
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
  /// Bytes of all mappings, at most. Context: setup.
  std::uint64_t room() const noexcept;

  /// Maps a segment and checks that it matches the application. The cycling thread adopts it at its next cycle
  /// boundary. Refuses a segment that does not match. Context: main thread; may block.
  Result<void> offer(std::uint32_t peer, std::uint32_t incarnation, int descriptor);
  /// Unmaps the released segments. Context: main thread; may block.
  void clear();

  /// Starts to use an offered segment; true if there is a new one. The segment before stays mapped until
  /// release_mapping(). Context: cycle boundary; wait-free.
  bool adopt(std::uint32_t peer) noexcept;
  /// No task reads the predecessor of the adopted segment any more. Context: cycle boundary; wait-free.
  void release_mapping(std::uint32_t peer) noexcept;
  /// The adopted segment; nullptr: none yet. Context: cycle boundary; wait-free.
  const PeerSegment* at(std::uint32_t peer) const noexcept {
    const Mapping* present = slots_[peer]->present;
    return present == nullptr ? nullptr : &present->segment;
  }

 private:
  struct Mapping {
    PeerSegment segment;
    Mapping* next = nullptr;  // in the list of released mappings
  };
  struct Slot {
    // SYNC: offer() (main thread) releases a complete mapping; adopt() (cycling thread) acquires it.
    std::atomic<Mapping*> offered{nullptr};
    Mapping* present = nullptr;   // used by the cycling thread
    Mapping* previous = nullptr;  // used by the cycling thread
  };

  MappedPeers() = default;
  const ApplicationSpec* spec_ = nullptr;
  HeapMemory memory_;  // memory of `layouts_`
  std::vector<PeerLayout> layouts_;
  std::vector<std::unique_ptr<Slot>> slots_;
  // SYNC: release_mapping() (cycling thread) releases the list; clear() (main thread) acquires it and unmaps.
  std::atomic<Mapping*> released_{nullptr};
};

}  // namespace chimera
