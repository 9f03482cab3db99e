// SPDX-License-Identifier: Apache-2.0
// Groups are given to one incarnation of one task and reused only when nobody can write or read them any more.
// Modelled in tests/models/group_reuse.pml.
//
//   free --take--> in use --retire(generation)--> retired --reclaim--> free
//
// reclaim asks two things of a retired group: its writer has ended, by its own acknowledgement of OFF or by proof of
// death (mere silence is no proof: it may wake up and write); and every ON task has adopted the generation of the
// retirement or a later one (before that it may still read). The counter of the group goes on where it stood.
#pragma once

#include <cstdint>
#include <span>
#include <string_view>

#include "chimera/base/ids.h"
#include "chimera/base/result.h"
#include "chimera/table/segment.h"

namespace chimera {

/// What a task says of itself: the generation of the BindingTable it works by, published at its cycle edge.
struct Adoption {
  std::string_view name;
  bool is_on = false;
  std::uint64_t generation = 0;
};

/// How we know that a writer writes no more.
enum class WriterEnd : std::uint8_t { kNone, kAcknowledgedOff, kProvedDead };

struct PooledGroup {
  enum class State : std::uint8_t { kFree, kInUse, kRetired };
  Link link;
  State state = State::kFree;
  WriterEnd writer_end = WriterEnd::kNone;
  TaskId writer;
  std::uint64_t retired_at = 0;  ///< first generation that does not name the group
};

/// Plain logic over groups that the caller keeps. One owner; not shared. Context: setup.
class GroupPool {
 public:
  explicit GroupPool(std::span<PooledGroup> groups) noexcept : groups_(groups) {}

  /// The smallest free group with room for `payload_bytes`, now belonging to `writer`. Its index counts in the span
  /// given. When there is none the message says for whom the pool waits. `tasks` is indexed by TaskId.
  Result<GroupId> take(TaskId writer, std::uint32_t payload_bytes, std::span<const Adoption> tasks) noexcept;
  /// From generation `generation` on no binding names the group. Requires: in use.
  void retire(GroupId id, std::uint64_t generation) noexcept;
  /// The writer of the group writes no more. Legal before or after retire().
  void writer_ended(GroupId id, WriterEnd how) noexcept;
  /// Frees what may be reused; how many groups that were.
  std::uint32_t reclaim(std::span<const Adoption> tasks) noexcept;

  const PooledGroup& group(GroupId id) const noexcept;

 private:
  PooledGroup& at(GroupId id) noexcept;
  std::span<PooledGroup> groups_;
};

}  // namespace chimera
