// SPDX-License-Identifier: Apache-2.0
#include "chimera/table/group.h"

#include "chimera/base/assert.h"
#include "chimera/table/shared_copy.h"

namespace chimera {
namespace {

static_assert(std::atomic_ref<std::uint64_t>::is_always_lock_free, "the counter is read on read-only mappings");
static_assert(sizeof(chimera_slot) == 32 && alignof(chimera_slot) == 8, "format of docs/formats/table.md");
static_assert((kSlots & (kSlots - 1)) == 0, "the counter wraps modulo a power of two");

// A copy of slot n is whole as long as publication n + kSlots was not begun, and that begins once the counter
// says n + kSlots - 1.
constexpr std::uint64_t kNewestPublicationWhileWhole = kSlots - 2;

constexpr bool is_aligned(const std::byte* p, std::size_t to) noexcept {
  return reinterpret_cast<std::uintptr_t>(p) % to == 0;
}

std::byte* slot_at(std::byte* base, std::uint64_t n, std::uint32_t stride) noexcept {
  return base + kCacheLine + (n % kSlots) * stride;
}

const std::byte* slot_at(const std::byte* base, std::uint64_t n, std::uint32_t stride) noexcept {
  return base + kCacheLine + (n % kSlots) * stride;
}

}  // namespace

GroupWriter::GroupWriter(std::span<std::byte> memory, std::uint32_t payload_bytes) noexcept
    : base_(memory.data()),
      payload_bytes_(payload_bytes),
      stride_(static_cast<std::uint32_t>(slot_stride(payload_bytes))) {
  CHIMERA_ASSERT(memory.size() >= group_bytes(payload_bytes));
  CHIMERA_ASSERT(is_aligned(base_, kCacheLine));
  latest_ = shared_copy::word(base_).load(std::memory_order_acquire);  // pairs with publish() of a predecessor
  shared_copy::release_fence();  // as at the end of publish()
}

std::byte* GroupWriter::staging() const noexcept {
  return slot_at(base_, latest_ + 1, stride_) + sizeof(chimera_slot);
}

void GroupWriter::publish(Nanoseconds now, std::uint64_t valid) noexcept {
  const chimera_slot header{now.count, latest_ + 1, valid, 0};
  shared_copy::copy_in(slot_at(base_, latest_ + 1, stride_), &header, sizeof header);
  ++latest_;
  // Whoever loads this value sees the whole slot. pairs with the first load of try_read()
  shared_copy::word(base_).store(latest_, std::memory_order_release);
  // Whoever sees a byte of the next staging sees this counter. pairs with the fence of try_read()
  shared_copy::release_fence();
}

void GroupWriter::write(const std::byte* values, Nanoseconds now, std::uint64_t valid) noexcept {
  shared_copy::copy_in(staging(), values, payload_bytes_);
  publish(now, valid);
}

void GroupWriter::prefill() noexcept {
  shared_copy::move_inside(staging(), slot_at(base_, latest_, stride_) + sizeof(chimera_slot), payload_bytes_);
}

std::uint64_t GroupWriter::sequence() const noexcept { return latest_; }

GroupReader::GroupReader(const std::byte* memory, std::uint32_t payload_bytes) noexcept
    : base_(memory), payload_bytes_(payload_bytes), stride_(static_cast<std::uint32_t>(slot_stride(payload_bytes))) {
  CHIMERA_ASSERT(is_aligned(base_, kCacheLine));
}

bool GroupReader::try_read(chimera_slot& header, std::byte* values) const noexcept {
  std::uint64_t n = shared_copy::word(base_).load(std::memory_order_acquire);  // pairs with the store of publish()
  for (std::uint32_t tries = 0; tries < kReadTries; ++tries) {
    const std::byte* slot = slot_at(base_, n, stride_);
    shared_copy::copy_out(values, slot + sizeof header, payload_bytes_);
    shared_copy::copy_out(&header, slot, sizeof header);
    shared_copy::acquire_fence();  // pairs with the fence of publish()
    const std::uint64_t m = shared_copy::word(base_).load(std::memory_order_acquire);  // acquire for the next try
    if (m - n <= kNewestPublicationWhileWhole) return true;
    n = m;
  }
  return false;
}

const chimera_slot* GroupReader::published() const noexcept {
  const std::uint64_t n = shared_copy::word(base_).load(std::memory_order_acquire);
  return reinterpret_cast<const chimera_slot*>(slot_at(base_, n, stride_));
}

}  // namespace chimera
