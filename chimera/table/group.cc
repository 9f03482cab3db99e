// SPDX-License-Identifier: Apache-2.0
// Checks the memory of a group, and repeats a read that the writer overtook.
#include "chimera/table/group.h"

#include "chimera/base/assert.h"

namespace chimera {
namespace {

// A machine without an operating system has no mappings and one context: a library call may stand for the atomic.
static_assert(std::atomic_ref<std::uint64_t>::is_always_lock_free || __STDC_HOSTED__ == 0,
              "the counter is read on read-only mappings");
static_assert(sizeof(chimera_slot) == 32 && alignof(chimera_slot) == 8, "format of docs/formats/table.md");
static_assert((kSlots & (kSlots - 1)) == 0, "the counter wraps modulo a power of two");

bool is_aligned(const std::byte* p, std::size_t to) noexcept { return reinterpret_cast<std::uintptr_t>(p) % to == 0; }

}  // namespace

RegisterWriter::RegisterWriter(std::span<std::byte> memory, std::uint32_t payload_bytes) noexcept
    : base_(memory.data()),
      payload_bytes_(payload_bytes),
      stride_(static_cast<std::uint32_t>(slot_stride(payload_bytes))) {
  CHIMERA_ASSERT(memory.size() >= group_bytes(payload_bytes));
  CHIMERA_ASSERT(is_aligned(base_, kCacheLine));
  latest_ = shared_copy::word(base_).load(std::memory_order_acquire);  // pairs with publish() of a predecessor
  shared_copy::release_fence();  // as at the end of publish()
}

RegisterReader::RegisterReader(const std::byte* memory, std::uint32_t payload_bytes) noexcept
    : base_(memory), payload_bytes_(payload_bytes), stride_(static_cast<std::uint32_t>(slot_stride(payload_bytes))) {
  CHIMERA_ASSERT(is_aligned(base_, kCacheLine));
}

void RegisterWriter::publish_initial(Nanoseconds now, std::uint64_t valid) noexcept {
  // Stored before the counter: a reader that sees the publication also sees this number. Pairs, through the counter,
  // with the load of is_initial().
  shared_copy::word(base_ + kInitialAt).store(latest_ + 1, std::memory_order_release);
  publish(now, valid);
}

bool RegisterReader::is_initial(std::uint64_t sequence) const noexcept {
  // Pairs with the store of publish_initial(). Callers read a publication before they ask about it.
  return sequence <= shared_copy::word(base_ + kInitialAt).load(std::memory_order_acquire);
}

bool RegisterReader::try_read_part(chimera_slot& header, std::uint32_t offset,
                                std::span<std::byte> values) const noexcept {
  CHIMERA_ASSERT(offset % sizeof(std::uint64_t) == 0 && offset + values.size() <= payload_bytes_);
  std::uint64_t n = shared_copy::word(base_).load(std::memory_order_acquire);  // pairs with the store of publish()
  for (std::uint32_t tries = 0; tries < kReadTries; ++tries) {
    const std::byte* from = slot(n);
    shared_copy::load_header(header, from);
    shared_copy::copy_out(values.data(), from + sizeof header + offset, values.size());
    if (was_whole(base_, n)) return true;
  }
  return false;
}

bool RegisterReader::try_again(std::uint64_t n, chimera_slot& header, std::byte* values) const noexcept {
  for (std::uint32_t tries = 1; tries < kReadTries; ++tries)
    if (read_slot(n, header, values)) return true;
  return false;
}

bool RegisterReader::try_again(std::uint64_t n, chimera_slot* to) const noexcept {
  for (std::uint32_t tries = 1; tries < kReadTries; ++tries)
    if (read_slot(n, to)) return true;
  return false;
}

}  // namespace chimera
