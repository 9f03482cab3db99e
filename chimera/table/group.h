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
// Invariants: (1) slot c mod 4, where c is the counter, is complete and no thread writes it; (2) the writer writes only
// slot (c+1) mod 4; (3) the counter only grows, by one for each publication. If a writer dies at any instruction, all
// three still hold: its successor fills slot (c+1) mod 4 again and repairs nothing. Readers never store.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <type_traits>

#include "chimera/base/mechanisms.h"
#include "chimera/base/time.h"
#include "chimera/table/plain_group.h"
#include "chimera/table/shared_copy.h"
#include "chimera/table/slot.h"

namespace chimera {

/// The writing side. Exactly one per group at any time; the memory outlives it.
class RegisterWriter {
 public:
  RegisterWriter() noexcept = default;
  /// Continues from the counter of `memory`; zeroed memory is a group never written. Requires: memory.size() >=
  /// group_bytes(payload_bytes), 64-byte aligned. Context: setup.
  RegisterWriter(std::span<std::byte> memory, std::uint32_t payload_bytes) noexcept;

  /// Memory for the values of the next publication; 8-byte aligned. The address changes with every publish(). Until
  /// prefill() the memory holds the values of four publications ago. Context: cycle; wait-free.
  std::byte* staging() const noexcept { return slot_of(latest_ + 1) + sizeof(chimera_slot); }
  /// Makes the staged values the latest. Context: cycle; wait-free.
  void publish(Nanoseconds now, std::uint64_t valid) noexcept;
  /// Publishes values that no method computed: the initial values of a new incarnation. Context: setup.
  void publish_initial(Nanoseconds now, std::uint64_t valid) noexcept;
  /// Stages payload_bytes from `values` and publishes them. A task with a local table calls this after a method.
  /// Context: cycle; wait-free; O(payload).
  void write(const std::byte* values, Nanoseconds now, std::uint64_t valid) noexcept;
  /// Copies the latest published values into staging, so that each output keeps its value until a method writes it.
  /// Context: cycle; wait-free; O(payload).
  void prefill() noexcept;
  /// The latest publication; its values follow the header. They stay unchanged until the second publication after it.
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
  std::uint64_t latest_ = 0;  // equals the counter; no other thread stores to it
};

/// A reading side. Works on a read-only mapping.
class RegisterReader {
 public:
  RegisterReader() noexcept = default;
  /// Requires: as RegisterWriter. Context: setup.
  RegisterReader(const std::byte* memory, std::uint32_t payload_bytes) noexcept;

  /// Copies the latest publication whole: header to `header`, payload_bytes to `values`. False, with both
  /// unchanged or partly overwritten, after kReadTries attempts were overtaken: the caller keeps its
  /// previous copy (double-buffered) and counts it stale.
  /// Context: cycle; bounded; plain loads only.
  [[nodiscard]] bool try_read(chimera_slot& header, std::byte* values) const noexcept {
    std::uint64_t n = shared_copy::word(base_).load(std::memory_order_acquire);  // pairs with the store of publish()
    return read_slot(n, header, values) || try_again(n, header, values);
  }
  /// Reads into a copy of a slot, whose values follow its header: one copy instead of two. Requires:
  /// sizeof(chimera_slot) + payload_bytes at `to`. Context: cycle; bounded; plain loads only.
  [[nodiscard]] bool try_read(chimera_slot* to) const noexcept {
    std::uint64_t n = shared_copy::word(base_).load(std::memory_order_acquire);  // pairs with the store of publish()
    return read_slot(n, to) || try_again(n, to);
  }
  /// Copies the header and `values.size()` bytes from `offset` on, for readers of a part of a large group. Requires:
  /// offset divisible by 8, offset + values.size() <= payload_bytes(). Context: cycle; bounded; plain loads only.
  [[nodiscard]] bool try_read_part(chimera_slot& header, std::uint32_t offset,
                                   std::span<std::byte> values) const noexcept;
  /// The latest published slot in place: its values follow the header. Requires: writer and reader run in one context,
  /// so that no publication occurs while the pointer is in use. Context: cycle; wait-free.
  const chimera_slot* published() const noexcept;
  /// True if publication `sequence` holds initial values that no method of a task computed. Context: cycle boundary;
  /// wait-free.
  bool is_initial(std::uint64_t sequence) const noexcept;
  std::uint32_t payload_bytes() const noexcept { return payload_bytes_; }
  /// False for a reader that was made without memory: it must not read.
  bool is_bound() const noexcept { return base_ != nullptr; }

 private:
  const std::byte* slot(std::uint64_t n) const noexcept { return base_ + kCacheLine + n % kSlots * stride_; }

  // Tries once to read publication n. If the writer overtook the copy, sets n to the latest publication.
  bool read_slot(std::uint64_t& n, chimera_slot& header, std::byte* values) const noexcept {
    const std::byte* from = slot(n);
    shared_copy::load_header(header, from);
    shared_copy::copy_out(values, from + sizeof header, payload_bytes_);
    return was_whole(base_, n);
  }
  bool read_slot(std::uint64_t& n, chimera_slot* to) const noexcept {
    const std::byte* const base = base_;  // the compiler must assume that a copy may write anywhere
    shared_copy::copy_out(to, slot(n), sizeof *to + payload_bytes_);
    return was_whole(base, n);
  }
  // Checks, after a copy of slot n, that the writer did not touch the slot. Sets n to the latest publication.
  static bool was_whole(const std::byte* base, std::uint64_t& n) noexcept {
    shared_copy::acquire_fence();  // pairs with the fence at the end of publish()
    const std::uint64_t m = shared_copy::word(base).load(std::memory_order_acquire);  // acquire: for the next try
    const bool is_whole = m - n <= kSlots - 2;  // n + kSlots begins when the counter is n + kSlots - 1
    n = m;
    return is_whole;
  }
  // All tries after the first; rarely needed.
  bool try_again(std::uint64_t n, chimera_slot& header, std::byte* values) const noexcept;
  bool try_again(std::uint64_t n, chimera_slot* to) const noexcept;

  const std::byte* base_ = nullptr;
  std::uint32_t payload_bytes_ = 0;
  std::uint32_t stride_ = 0;
};

inline void RegisterWriter::publish(Nanoseconds now, std::uint64_t valid) noexcept {
  // Loads all members first: the compiler must assume that a store to the group may change them.
  std::byte* const base = base_;
  const std::uint64_t n = latest_ + 1;
  shared_copy::store_header(slot_of(n), {now.count, n, valid, 0});
  // A reader that loads this value sees the whole slot. Pairs with the first load of try_read().
  shared_copy::word(base).store(n, std::memory_order_release);
  // A reader that sees a byte of the next staging sees this counter. Pairs with the fence of read_slot().
  shared_copy::release_fence();
  latest_ = n;
}

inline void RegisterWriter::prefill() noexcept {
  shared_copy::move_inside(staging(), slot_of(latest_) + sizeof(chimera_slot), payload_bytes_);
}

inline void RegisterWriter::write(const std::byte* values, Nanoseconds now, std::uint64_t valid) noexcept {
  shared_copy::copy_in(staging(), values, payload_bytes_);
  publish(now, valid);
}

inline const chimera_slot* RegisterReader::published() const noexcept {
  return reinterpret_cast<const chimera_slot*>(slot(shared_copy::word(base_).load(std::memory_order_acquire)));
}

/// The sides of a group: of the register, or of a plain group where no context reads copies.
using GroupWriter = std::conditional_t<mechanisms::kCopies, RegisterWriter, PlainGroupWriter>;
using GroupReader = std::conditional_t<mechanisms::kCopies, RegisterReader, PlainGroupReader>;

}  // namespace chimera
