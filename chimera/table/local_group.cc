// SPDX-License-Identifier: Apache-2.0
#include "chimera/table/local_group.h"

#include "chimera/base/assert.h"

namespace chimera {

LocalGroup::LocalGroup(GroupReader reader, std::span<std::byte> memory) noexcept
    : reader_(reader), memory_(memory.data()) {
  CHIMERA_ASSERT(memory.size() >= local_group_bytes(reader.payload_bytes()));
  CHIMERA_ASSERT(reinterpret_cast<std::uintptr_t>(memory_) % kCacheLine == 0);
  *at(0) = {};
  *at(1) = {};
}

std::span<std::byte> LocalGroup::values_of_half(std::uint32_t half) const noexcept {
  CHIMERA_ASSERT(half < 2);
  return {reinterpret_cast<std::byte*>(at(half) + 1), reader_.payload_bytes()};
}

bool LocalGroup::refresh() noexcept {
  chimera_slot* spare = at(1 - used_);
  if (!reader_.try_read(*spare, reinterpret_cast<std::byte*>(spare + 1))) {
    ++stale_;
    return false;
  }
  used_ = 1 - used_;
  return true;
}

void LocalGroup::rebind(GroupReader reader) noexcept {
  CHIMERA_ASSERT(reader.payload_bytes() == reader_.payload_bytes());
  reader_ = reader;
}

}  // namespace chimera
