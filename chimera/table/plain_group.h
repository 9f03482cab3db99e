// SPDX-License-Identifier: Apache-2.0
// The group of a context that is alone and in which one method runs at a time: no task reads while another one
// publishes, so one place for the published values is enough, and inputs of other tasks point at it for good.
//
//   [last initial publication: 8 bytes][chimera_slot header][published values][values of the next publication]
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <span>

#include "chimera/base/assert.h"
#include "chimera/base/time.h"
#include "chimera/table/slot.h"

namespace chimera {

/// The writing side, with the interface of the register (group.h).
class PlainGroupWriter {
 public:
  PlainGroupWriter() noexcept = default;
  /// Requires: memory.size() >= group_bytes(payload_bytes), 8-byte aligned. Context: setup.
  PlainGroupWriter(std::span<std::byte> memory, std::uint32_t payload_bytes) noexcept
      : base_(memory.data()), payload_bytes_(payload_bytes) {
    CHIMERA_ASSERT(memory.size() >= group_bytes(payload_bytes));
  }

  /// Its address stays. Context: cycle; wait-free.
  std::byte* staging() const noexcept { return values() + payload_bytes_; }
  /// Context: cycle; wait-free; O(payload).
  void publish(Nanoseconds now, std::uint64_t valid) noexcept {
    chimera_slot& slot = header();
    slot.published_ns = now.count;
    ++slot.sequence;
    slot.valid = valid;
    copy(values(), staging());
    has_news_ = false;
  }
  /// Context: setup.
  void publish_initial(Nanoseconds now, std::uint64_t valid) noexcept {
    *reinterpret_cast<std::uint64_t*>(base_) = sequence() + 1;
    publish(now, valid);
  }
  /// Context: cycle; wait-free; O(payload).
  void write(const std::byte* from, Nanoseconds now, std::uint64_t valid) noexcept {
    copy(staging(), from);
    publish(now, valid);
  }
  /// Copies nothing after a publication: the values are equal. Context: cycle; wait-free; O(payload).
  void prefill() noexcept {
    if (has_news_) copy(staging(), values());
    has_news_ = true;
  }
  /// Its address stays. Context: cycle; wait-free.
  const chimera_slot* published() const noexcept { return &header(); }
  std::uint64_t sequence() const noexcept { return header().sequence; }
  std::uint32_t payload_bytes() const noexcept { return payload_bytes_; }

 private:
  chimera_slot& header() const noexcept { return *reinterpret_cast<chimera_slot*>(base_ + kPlainHead); }
  std::byte* values() const noexcept { return base_ + kPlainHead + sizeof(chimera_slot); }
  void copy(std::byte* to, const std::byte* from) const noexcept {
    for (const std::byte* const end = from + payload_bytes_; from < end; from += 8, to += 8) {
      std::memcpy(to, from, 8);
      asm volatile("" : "+r"(from), "+r"(to));  // keeps the compiler from turning the loop into a call
    }
  }

  std::byte* base_ = nullptr;
  std::uint32_t payload_bytes_ = 0;
  bool has_news_ = true;  // the staged values may differ from the published ones
};

/// A reading side, with the interface of the register (group.h). A read always succeeds.
class PlainGroupReader {
 public:
  PlainGroupReader() noexcept = default;
  /// Context: setup.
  PlainGroupReader(const std::byte* memory, std::uint32_t payload_bytes) noexcept
      : base_(memory), payload_bytes_(payload_bytes) {}

  [[nodiscard]] bool try_read(chimera_slot& header, std::byte* values) const noexcept {
    header = *published();
    std::copy_n(reinterpret_cast<const std::byte*>(published() + 1), payload_bytes_, values);
    return true;
  }
  [[nodiscard]] bool try_read(chimera_slot* to) const noexcept {
    return try_read(*to, reinterpret_cast<std::byte*>(to + 1));
  }
  [[nodiscard]] bool try_read_part(chimera_slot& header, std::uint32_t offset,
                                   std::span<std::byte> values) const noexcept {
    header = *published();
    std::copy_n(reinterpret_cast<const std::byte*>(published() + 1) + offset, values.size(), values.begin());
    return true;
  }
  const chimera_slot* published() const noexcept { return reinterpret_cast<const chimera_slot*>(base_ + kPlainHead); }
  bool is_initial(std::uint64_t sequence) const noexcept {
    return sequence <= *reinterpret_cast<const std::uint64_t*>(base_);
  }
  std::uint32_t payload_bytes() const noexcept { return payload_bytes_; }
  bool is_bound() const noexcept { return base_ != nullptr; }

 private:
  const std::byte* base_ = nullptr;
  std::uint32_t payload_bytes_ = 0;
};

}  // namespace chimera
