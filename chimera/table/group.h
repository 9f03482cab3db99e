// SPDX-License-Identifier: Apache-2.0
// The register: all outputs of one task, published together, one writer, any number of readers.
// Non-blocking write (Kopetz & Reisinger 1993) with four slots: docs/formats/table.md has the proof sketch.
//
//   writer:  fence | fill slot (n+1) mod 4 | counter = n+1
//   reader:  n = counter | copy slot n mod 4 | fence | m = counter | valid while m - n <= 2, else try again
//
//   counter   slot 0   slot 1   slot 2   slot 3      a reader that loaded n = 4 copies slot 0:
//      4      [ 4 ]    < 5 >      2        3         m = 4: nothing happened to it
//      5        4      [ 5 ]    < 6 >      3         m = 5: not touched
//      6        4        5      [ 6 ]    < 7 >       m = 6: not touched: m - n = 2 is the last good one
//      7      < 8 >      5        6      [ 7 ]       m = 7: 8 may be half written over it: try again
//             [latest publication]  <being filled>
//
// Invariants: (1) slot c mod 4, c the counter, is complete and nobody writes it; (2) the only slot written to is
// (c+1) mod 4; (3) the counter only grows, by one a publication. A writer that dies at any instruction leaves
// all three true: nothing is repaired, its successor fills slot (c+1) mod 4 again. Readers never store.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

#include "chimera/base/time.h"
#include "chimera/table/shared_copy.h"
#include "chimera/table/slot.h"

namespace chimera {

/// The writing side. Exactly one per group at any time; the memory outlives it.
class GroupWriter {
 public:
  GroupWriter() noexcept = default;
  /// Takes up writing where the counter of `memory` stands; zeroed memory is a group never written.
  /// Requires: memory.size() >= group_bytes(payload_bytes), 64-byte aligned. Context: setup.
  GroupWriter(std::span<std::byte> memory, std::uint32_t payload_bytes) noexcept;

  /// Where the next publication's values go; 8-byte aligned. Changes with every publish(). What stands there is
  /// that of four publications ago until prefill(). Context: cycle; wait-free.
  std::byte* staging() const noexcept { return slot_of(latest_ + 1) + sizeof(chimera_slot); }
  /// Makes the staged values the latest. Context: cycle; wait-free.
  void publish(Nanoseconds now, std::uint64_t valid) noexcept;
  /// The same for values that no method of a task has made: the initial values of a new incarnation. Context: setup.
  void publish_initial(Nanoseconds now, std::uint64_t valid) noexcept;
  /// Stages payload_bytes from `values` and publishes them: what a task with a local table does after a method.
  /// Context: cycle; wait-free; O(payload).
  void write(const std::byte* values, Nanoseconds now, std::uint64_t valid) noexcept;
  /// Copies the latest published values into staging, so that outputs stand until overwritten.
  /// Context: cycle; wait-free; O(payload).
  void prefill() noexcept;
  /// The latest publication, its values behind the header; nobody changes it before the next but one.
  /// Context: cycle; wait-free.
  const chimera_slot* published() const noexcept { return reinterpret_cast<const chimera_slot*>(slot_of(latest_)); }
  /// Publications so far. Context: cycle; wait-free.
  std::uint64_t sequence() const noexcept { return latest_; }
  std::uint32_t payload_bytes() const noexcept { return payload_bytes_; }

 private:
  std::byte* slot_of(std::uint64_t publication) const noexcept {
    return base_ + kCacheLine + publication % kSlots * stride_;
  }

  std::byte* base_ = nullptr;
  std::uint32_t payload_bytes_ = 0;
  std::uint32_t stride_ = 0;
  std::uint64_t latest_ = 0;  // what the counter says; nobody else stores to it
};

/// A reading side. Works on a read-only mapping.
class GroupReader {
 public:
  GroupReader() noexcept = default;
  /// Requires: as GroupWriter. Context: setup.
  GroupReader(const std::byte* memory, std::uint32_t payload_bytes) noexcept;

  /// Copies the latest publication whole: header to `header`, payload_bytes to `values`. False, with both
  /// unchanged or partly overwritten, after kReadTries attempts were overtaken: the caller keeps its
  /// previous copy (double-buffered) and counts it stale.
  /// Context: cycle; bounded; plain loads only.
  [[nodiscard]] bool try_read(chimera_slot& header, std::byte* values) const noexcept {
    std::uint64_t n = shared_copy::word(base_).load(std::memory_order_acquire);  // pairs with the store of publish()
    return read_slot(n, header, values) || try_again(n, header, values);
  }
  /// The same into a copy of a slot, whose values follow its header: one copy instead of two.
  /// Requires: sizeof(chimera_slot) + payload_bytes at `to`. Context: cycle; bounded; plain loads only.
  [[nodiscard]] bool try_read(chimera_slot* to) const noexcept {
    std::uint64_t n = shared_copy::word(base_).load(std::memory_order_acquire);  // pairs with the store of publish()
    return read_slot(n, to) || try_again(n, to);
  }
  /// Copies `values.size()` bytes from `offset` on, and the header: of a large group no more than is wanted.
  /// Requires: offset divisible by 8, offset + values.size() <= payload_bytes(). Context: cycle; bounded; plain loads
  /// only.
  [[nodiscard]] bool try_read_part(chimera_slot& header, std::uint32_t offset,
                                   std::span<std::byte> values) const noexcept;
  /// The latest published slot in place: its values follow the header. Only where writer and reader run
  /// in one context, so that nothing is published while the pointer is in use.
  /// Context: cycle; wait-free.
  const chimera_slot* published() const noexcept;
  /// True when publication `sequence` holds initial values and was made by no method of a task.
  /// Context: cycle boundary; wait-free.
  bool is_initial(std::uint64_t sequence) const noexcept;
  std::uint32_t payload_bytes() const noexcept { return payload_bytes_; }
  /// False for one that was made without memory: it must not be read.
  bool is_bound() const noexcept { return base_ != nullptr; }

 private:
  const std::byte* slot(std::uint64_t n) const noexcept { return base_ + kCacheLine + n % kSlots * stride_; }

  // One try at publication n; when it was overtaken, n becomes the latest.
  bool read_slot(std::uint64_t& n, chimera_slot& header, std::byte* values) const noexcept {
    const std::byte* from = slot(n);
    shared_copy::load_header(header, from);
    shared_copy::copy_out(values, from + sizeof header, payload_bytes_);
    return was_whole(base_, n);
  }
  bool read_slot(std::uint64_t& n, chimera_slot* to) const noexcept {
    const std::byte* const base = base_;  // a copy may write anywhere, as the compiler sees it
    shared_copy::copy_out(to, slot(n), sizeof *to + payload_bytes_);
    return was_whole(base, n);
  }
  // After a copy of slot n: was it left alone? Then n becomes the latest.
  static bool was_whole(const std::byte* base, std::uint64_t& n) noexcept {
    shared_copy::acquire_fence();  // pairs with the fence at the end of publish()
    const std::uint64_t m = shared_copy::word(base).load(std::memory_order_acquire);  // acquire: for the next try
    const bool is_whole = m - n <= kSlots - 2;  // n + kSlots is begun once the counter says n + kSlots - 1
    n = m;
    return is_whole;
  }
  // The tries after the first, seldom needed.
  bool try_again(std::uint64_t n, chimera_slot& header, std::byte* values) const noexcept;
  bool try_again(std::uint64_t n, chimera_slot* to) const noexcept;

  const std::byte* base_ = nullptr;
  std::uint32_t payload_bytes_ = 0;
  std::uint32_t stride_ = 0;
};

inline void GroupWriter::publish(Nanoseconds now, std::uint64_t valid) noexcept {
  // All members are loaded first: a store to the group may change them, as the compiler sees it.
  std::byte* const base = base_;
  const std::uint64_t n = latest_ + 1;
  shared_copy::store_header(slot_of(n), {now.count, n, valid, 0});
  // Whoever loads this value sees the whole slot. pairs with the first load of try_read()
  shared_copy::word(base).store(n, std::memory_order_release);
  // Whoever sees a byte of the next staging sees this counter. pairs with the fence of read_slot()
  shared_copy::release_fence();
  latest_ = n;
}

inline void GroupWriter::prefill() noexcept {
  shared_copy::move_inside(staging(), slot_of(latest_) + sizeof(chimera_slot), payload_bytes_);
}

inline void GroupWriter::write(const std::byte* values, Nanoseconds now, std::uint64_t valid) noexcept {
  shared_copy::copy_in(staging(), values, payload_bytes_);
  publish(now, valid);
}

inline const chimera_slot* GroupReader::published() const noexcept {
  return reinterpret_cast<const chimera_slot*>(slot(shared_copy::word(base_).load(std::memory_order_acquire)));
}

}  // namespace chimera
