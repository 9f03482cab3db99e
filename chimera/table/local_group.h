// SPDX-License-Identifier: Apache-2.0
// A task's own copy of a group that another context produces. Two halves: one is used, the other is read into;
// they change places only when a read succeeded, so that an overtaken read never spoils what the task sees.
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
  /// Until the first successful refresh() the slot is never-written with the values that stand in `memory`: fill
  /// values_of_half() of both halves before use. Requires: memory.size() >= local_group_bytes(payload), 64-byte
  /// aligned. Context: setup.
  LocalGroup(GroupReader reader, std::span<std::byte> memory) noexcept;

  /// Where the values of half 0 or 1 lie: for the never-written fill. Context: setup.
  std::span<std::byte> values_of_half(std::uint32_t half) const noexcept;

  /// Takes over the latest publication. False when the writer overtook every try: the previous copy stays and
  /// counts as stale. Context: cycle; bounded; O(payload).
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
  /// From now on reads `reader`, keeping the present copy until the next refresh(). Requires: same payload size.
  /// Context: cycle; wait-free.
  void rebind(GroupReader reader) noexcept;

  /// The present copy: header, then values. Changes its place with refresh(). Context: cycle; wait-free.
  const chimera_slot* slot() const noexcept { return used_; }
  /// Reads that were overtaken, since construction.
  std::uint64_t stale() const noexcept { return stale_; }

 private:
  GroupReader reader_;
  std::byte* memory_ = nullptr;
  chimera_slot* used_ = nullptr;
  chimera_slot* spare_ = nullptr;
  std::uint64_t stale_ = 0;
};

}  // namespace chimera
