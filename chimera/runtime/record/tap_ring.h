// SPDX-License-Identifier: Apache-2.0
// The tap: one writer appends fixed-size records, any number of readers follow on read-only mappings. The writer
// never looks at a reader; one that falls behind by a whole ring loses the oldest and learns how many.
//
//   writer: records[head mod N] = record (word-wise) ; head = head + 1 (release)
//   reader: h = head (acquire) | copy | fence | valid while head - index < N - 1, else skipped and counted
#pragma once

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <span>

#include "chimera/runtime/record/tap_record.h"
#include "chimera/table/slot_header.h"

namespace chimera {

inline constexpr std::size_t kTapRecords = 1u << 15;  // 1 MiB: 0.3 s at 100 records a millisecond

/// In the writer's segment; zeroed memory is an empty ring.
struct TapRing {
  std::atomic<std::uint64_t> head{0};  ///< store-release by Tap::append() pairs with the acquire of TapReader::read()
  std::uint64_t reserved[7] = {};
  TapRecord records[kTapRecords];
};

/// The writing side. One writer. Context of appending: cycle; wait-free.
class Tap {
 public:
  explicit Tap(TapRing& ring) noexcept : ring_(&ring), head_(ring.head.load(std::memory_order_relaxed)) {}
  void append(const TapRecord& record) noexcept;
  /// A publication of `task`, as one kGroup and a kValue for each 8 bytes: row number `row` of the task. The payload
  /// follows `slot`. O(payload). Requires: payload_bytes a multiple of 8.
  void append_row(const chimera_slot& slot, std::uint32_t payload_bytes, TaskId task, std::uint8_t rtpu,
                  std::uint32_t row) noexcept;

 private:
  void append(std::uint64_t at, std::uint64_t b, std::uint64_t a_and_task, std::uint64_t rest) noexcept;

  TapRing* ring_;
  std::uint64_t head_;
};

/// A reading side.
class TapReader {
 public:
  TapReader() noexcept = default;
  /// Begins with the next record (or with the oldest still there). Context: setup.
  explicit TapReader(const TapRing& ring, bool from_oldest = false) noexcept;
  /// Moves up to out.size() records to `out`; returns how many. Records that were overwritten before they could be read
  /// are added to lost(). Context: any; wait-free but for O(out).
  std::size_t read(std::span<TapRecord> out) noexcept;
  std::uint64_t lost() const noexcept { return lost_; }
  /// Number of the next record to be read, from 0 at the start of the ring.
  std::uint64_t position() const noexcept { return next_; }

 private:
  const TapRing* ring_ = nullptr;
  std::uint64_t next_ = 0;
  std::uint64_t lost_ = 0;
};

}  // namespace chimera
