// SPDX-License-Identifier: Apache-2.0
// Builds rows from the tap's records: a publication of a task is whole, or it is left out and counted.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "chimera/runtime/record/tap_record.h"

namespace chimera {

/// One publication of a task.
struct TapRow {
  TaskId task;
  std::uint32_t number = 0;         ///< among the rows of this task in this ring
  std::uint64_t sequence = 0;       ///< of the publication in its group
  Nanoseconds at;                   ///< when it was published
  std::uint64_t lost = 0;           ///< rows of this task lost since the row before this one
  std::span<const std::byte> payload;  ///< laid out as the group's (table/layout.h); valid until the next take()
};

/// The reader's side of Tap::append_row(), for one ring. It only returns whole rows of the stated sizes, even if the
/// records are wrong. Context: any one thread; no allocation after construction.
class TapRows {
 public:
  /// `payload_bytes[i]`: of the output group of task i, a multiple of 8. Context: setup.
  explicit TapRows(std::span<const std::uint32_t> payload_bytes);

  /// Takes the next record of the ring; answers the row that it completes, else null. Records of other kinds are
  /// passed over.
  const TapRow* take(const TapRecord& record) noexcept;
  /// Rows of the task known to be lost: gaps before rows that came out. Requires: a task of the constructor.
  std::uint64_t lost(TaskId task) const noexcept { return of_[task.index].lost; }

 private:
  struct OfTask {
    std::vector<std::uint64_t> words;
    std::uint32_t next = 0;         // number of the row expected next
    std::uint32_t taken = 0;        // words of the open row
    bool is_open = false;
    bool has_begun = false;         // a row has come out: from now on gaps are known
    std::uint64_t lost = 0;
    TapRow row;
  };
  const TapRow* finish(OfTask& t) noexcept;

  std::vector<OfTask> of_;
};

}  // namespace chimera
