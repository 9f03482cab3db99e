// SPDX-License-Identifier: Apache-2.0
// The tap: a bounded ring of TapRecords, one writer, one reader on another thread or afterwards.
// The writer never waits: when the ring is full the new record is dropped and counted, so what is in the ring is
// always a gapless beginning; the reader sees the number of drops.
//
//   writer: slot[head & mask] = record; head = head + 1 (release)   |   reader: tail..head (acquire); tail (release)
#pragma once

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <span>

#include "chimera/runtime/tap_record.h"

namespace chimera {

/// Over memory that the giver keeps alive.
class Tap {
 public:
  /// Requires: ring.size() a power of two, at least 2. Context: setup.
  explicit Tap(std::span<TapRecord> ring) noexcept;

  /// Adds a record, or drops it when the reader is a whole ring behind.
  /// Context: cycle; wait-free; the one writer only.
  void append(const TapRecord& record) noexcept {
    const std::uint64_t head = head_.load(std::memory_order_relaxed);
    if (head - tail_seen_ == ring_.size()) {
      // SYNC: pairs with the release in read(): the reader is done with the slots it passed.
      tail_seen_ = tail_.load(std::memory_order_acquire);
      if (head - tail_seen_ == ring_.size()) {
        dropped_.store(dropped_.load(std::memory_order_relaxed) + 1, std::memory_order_relaxed);
        return;
      }
    }
    ring_[head & (ring_.size() - 1)] = record;
    // SYNC: pairs with the acquire in read(): the record is whole before it is counted.
    head_.store(head + 1, std::memory_order_release);
  }

  /// Moves up to out.size() of the oldest records to `out`; returns how many.
  /// Context: any, the one reader only; wait-free.
  std::size_t read(std::span<TapRecord> out) noexcept;
  /// Records dropped so far. Context: any; wait-free.
  std::uint64_t dropped() const noexcept { return dropped_.load(std::memory_order_relaxed); }

 private:
  std::span<TapRecord> ring_;
  // Written by the writer.
  alignas(64) std::atomic<std::uint64_t> head_{0};
  std::atomic<std::uint64_t> dropped_{0};
  std::uint64_t tail_seen_ = 0;
  // Written by the reader.
  alignas(64) std::atomic<std::uint64_t> tail_{0};
};

}  // namespace chimera
