// SPDX-License-Identifier: Apache-2.0
// Lays out the two halves of a local copy of a group.
#include "chimera/table/local_group.h"

#include "chimera/base/assert.h"

namespace chimera {

LocalGroup::LocalGroup(GroupReader reader, std::span<std::byte> memory) noexcept
    : reader_(reader),
      memory_(memory.data()),
      used_(reinterpret_cast<chimera_slot*>(memory.data())),
      spare_(reinterpret_cast<chimera_slot*>(memory.data() + slot_stride(reader.payload_bytes()))) {
  CHIMERA_ASSERT(memory.size() >= local_group_bytes(reader.payload_bytes()));
  CHIMERA_ASSERT(reinterpret_cast<std::uintptr_t>(memory_) % kCacheLine == 0);
  *used_ = {};
  *spare_ = {};
}

std::span<std::byte> LocalGroup::values_of_half(std::uint32_t half) const noexcept {
  CHIMERA_ASSERT(half < 2);
  std::byte* slot = memory_ + half * slot_stride(reader_.payload_bytes());
  return {slot + sizeof(chimera_slot), reader_.payload_bytes()};
}

void LocalGroup::rebind(GroupReader reader) noexcept {
  CHIMERA_ASSERT(reader.payload_bytes() == reader_.payload_bytes());
  reader_ = reader;
}

}  // namespace chimera
