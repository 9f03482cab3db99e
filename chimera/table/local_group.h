// SPDX-License-Identifier: Apache-2.0
// The copy that a task keeps of a group from another context. The copy has two halves: the task uses one, and refresh()
// reads into the other. The halves change places only after a successful read, so an overtaken read never damages the
// used half.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

#include "chimera/table/group.h"

namespace chimera {

/// Bytes that a LocalGroup needs for `payload_bytes` of values. Context: any; wait-free.
constexpr std::size_t local_group_bytes(std::size_t payload_bytes) noexcept { return 2 * slot_stride(payload_bytes); }

/// The local copy of one group, used by one task. The memory is private to the task and outlives it.
class LocalGroup {
 public:
  LocalGroup() noexcept = default;
  /// Until the first successful refresh() the slot is never-written and holds the values in `memory`. Fill
  /// values_of_half() of both halves before use. Requires: memory.size() >= local_group_bytes(payload), 64-byte
  /// aligned. Context: setup.
  LocalGroup(GroupReader reader, std::span<std::byte> memory) noexcept;

  /// Address of the values of half 0 or 1, for the never-written fill. Context: setup.
  std::span<std::byte> values_of_half(std::uint32_t half) const noexcept;

  /// Copies the latest publication. False if the writer overtook every try: the previous copy stays and counts as
  /// stale. Context: cycle; bounded; O(payload).
  bool refresh() noexcept {
    if (!reader_.try_read(spare_)) [[unlikely]] {
      ++stale_;
      return false;
    }
    chimera_slot* read = spare_;
    spare_ = used_;
    used_ = read;
    return true;
  }
  /// Reads `reader` from now on; the present copy stays until the next refresh(). Requires: same payload size. Context:
  /// cycle; wait-free.
  void rebind(GroupReader reader) noexcept;

  /// The present copy: header, then values. Each refresh() may change its address. Context: cycle; wait-free.
  const chimera_slot* slot() const noexcept { return used_; }
  /// Number of overtaken reads since construction.
  std::uint64_t stale() const noexcept { return stale_; }

 private:
  GroupReader reader_;
  std::byte* memory_ = nullptr;
  chimera_slot* used_ = nullptr;
  chimera_slot* spare_ = nullptr;
  std::uint64_t stale_ = 0;
};

}  // namespace chimera
