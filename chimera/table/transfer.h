// SPDX-License-Identifier: Apache-2.0
// The transfer before a method: one GroupInput per group that a task reads. The same call whether the producer
// runs in the same context (the published slot is used in place) or elsewhere (copied through the register).
// The transfer after a method is GroupWriter::publish(), or write() from a local table.
#pragma once

#include <cstdint>
#include <span>

#include "chimera/table/group.h"
#include "chimera/table/local_group.h"

namespace chimera {

/// One group as a task reads it. Plain value; owned by one task.
class GroupInput {
 public:
  GroupInput() noexcept = default;
  /// The producer runs in this context: never while a method of the reader runs, so the slot cannot change under it.
  static GroupInput direct(GroupReader reader) noexcept;
  /// The producer runs elsewhere. Copies into `local`, which outlives the input.
  static GroupInput copied(LocalGroup& local) noexcept;

  /// As copied(), but `local` is refreshed by somebody else, once for all inputs that follow it.
  static GroupInput following(LocalGroup& local) noexcept;
  bool follows(const LocalGroup& local) const noexcept { return local_ == &local; }

  /// Brings slot() up to date. False when it stayed as it was because the writer overtook the read (counted by the
  /// LocalGroup). Context: cycle; bounded; O(1) when direct, else O(payload).
  bool latch() noexcept {
    if (local_ == nullptr) {
      slot_ = reader_.published();
      return true;
    }
    const bool fresh = !refreshes_ || local_->refresh();
    slot_ = local_->slot();
    return fresh;
  }
  /// The slot to use until the next latch(); the values follow it. Never null after the first latch().
  const chimera_slot* slot() const noexcept { return slot_; }
  /// Where the values of the latched slot begin. Context: cycle; wait-free.
  const std::byte* values() const noexcept { return reinterpret_cast<const std::byte*>(slot_ + 1); }
  bool is_direct() const noexcept { return local_ == nullptr; }

 private:
  GroupReader reader_;
  LocalGroup* local_ = nullptr;
  bool refreshes_ = true;
  const chimera_slot* slot_ = nullptr;
};

/// Latches every input; the number of those that stayed stale. Port pointers are resolved from slot() afterwards.
/// Consistent per group, not across groups. Context: cycle; bounded; O(bytes of the copied groups).
inline std::uint32_t transfer_in(std::span<GroupInput> inputs) noexcept {
  std::uint32_t stale = 0;
  for (GroupInput& input : inputs)
    if (!input.latch()) ++stale;
  return stale;
}

}  // namespace chimera
