// SPDX-License-Identifier: Apache-2.0
// The transfer before a method: one GroupInput for each group that a task reads. The call is the same for every
// producer. From the same context the published slot is used in place; from another one the register copies it.
// GroupWriter::publish() is the transfer after a method, or write() from a local table.
#pragma once

#include <cstdint>
#include <span>
#include <type_traits>

#include "chimera/base/mechanisms.h"
#include "chimera/table/group.h"
#include "chimera/table/local_group.h"

namespace chimera {

/// A group as a task reads it. Plain value; owned by one task.
class SharedGroupInput {
 public:
  SharedGroupInput() noexcept = default;
  /// For a producer in this context: it never runs during a method of the reader, so the slot cannot change.
  static SharedGroupInput direct(GroupReader reader) noexcept;
  /// For a producer in another context. Copies into `local`, which must outlive the input.
  static SharedGroupInput copied(LocalGroup& local) noexcept;

  /// Like copied(), but another caller refreshes `local`, once for all inputs that follow it.
  static SharedGroupInput following(LocalGroup& local) noexcept;
  bool follows(const LocalGroup& local) const noexcept { return local_ == &local; }

  /// Updates slot(). False if it is unchanged because the writer overtook the read (the LocalGroup counts this).
  /// Context: cycle; bounded; O(1) when direct, otherwise O(payload).
  bool latch() noexcept {
    if (local_ == nullptr) {
      slot_ = reader_.published();
      return true;
    }
    const bool fresh = !refreshes_ || local_->refresh();
    slot_ = local_->slot();
    return fresh;
  }
  /// The slot to use until the next latch(); the values follow the header. Never null after the first latch().
  const chimera_slot* slot() const noexcept { return slot_; }
  /// The values of the latched slot. Context: cycle; wait-free.
  const std::byte* values() const noexcept { return reinterpret_cast<const std::byte*>(slot_ + 1); }
  bool is_direct() const noexcept { return local_ == nullptr; }

 private:
  GroupReader reader_;
  LocalGroup* local_ = nullptr;
  bool refreshes_ = true;
  const chimera_slot* slot_ = nullptr;
};

/// The input of an image, where every producer is in this context: its slot stays where it is.
class DirectGroupInput {
 public:
  DirectGroupInput() noexcept = default;
  static DirectGroupInput direct(GroupReader reader) noexcept {
    DirectGroupInput input;
    input.slot_ = reader.published();
    return input;
  }
  static DirectGroupInput following(LocalGroup&) noexcept { return {}; }  ///< never called
  bool follows(const LocalGroup&) const noexcept { return false; }

  bool latch() noexcept { return true; }
  const chimera_slot* slot() const noexcept { return slot_; }
  const std::byte* values() const noexcept { return reinterpret_cast<const std::byte*>(slot_ + 1); }
  bool is_direct() const noexcept { return true; }

 private:
  const chimera_slot* slot_ = nullptr;
};

using GroupInput = std::conditional_t<mechanisms::kCopies, SharedGroupInput, DirectGroupInput>;

/// Latches every input and returns the number of stale ones. Resolve port pointers from slot() afterwards. Consistent
/// within a group, not across groups. Context: cycle; bounded; O(bytes of the copied groups).
inline std::uint32_t transfer_in(std::span<GroupInput> inputs) noexcept {
  std::uint32_t stale = 0;
  for (GroupInput& input : inputs)
    if (!input.latch()) ++stale;
  return stale;
}

}  // namespace chimera
