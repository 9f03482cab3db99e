// SPDX-License-Identifier: Apache-2.0
#include "chimera/table/group_pool.h"

#include "chimera/base/assert.h"
#include "chimera/base/message.h"

namespace chimera {
namespace {

using State = PooledGroup::State;

// The first ON task that may still read a group retired at `generation`; null when there is none.
const Adoption* late_reader(std::span<const Adoption> tasks, std::uint64_t generation) noexcept {
  for (const Adoption& task : tasks)
    if (task.is_on && task.generation < generation) return &task;
  return nullptr;
}

std::string_view name_of(TaskId id, std::span<const Adoption> tasks) noexcept {
  return id.index < tasks.size() ? tasks[id.index].name : std::string_view("?");
}

// Why this group, large enough, is not free.
void explain(Message& message, const PooledGroup& group, std::size_t index, std::span<const Adoption> tasks) noexcept {
  message << "; group " << index;
  if (group.state == State::kInUse) {
    message << " is in use by " << name_of(group.writer, tasks);
    return;
  }
  if (group.writer_end == WriterEnd::kNone)
    message << " waits for its writer " << name_of(group.writer, tasks) << " to acknowledge OFF or be proved dead";
  else if (const Adoption* late = late_reader(tasks, group.retired_at))
    message << " waits for " << late->name << " to adopt generation " << group.retired_at << " (is at "
            << late->generation << ")";
  else
    message << " waits to be reclaimed";
}

}  // namespace

Result<GroupId> GroupPool::take(TaskId writer, std::uint32_t payload_bytes,
                                std::span<const Adoption> tasks) noexcept {
  GroupId best;
  for (std::size_t i = 0; i < groups_.size(); ++i) {
    const PooledGroup& group = groups_[i];
    if (group.state != State::kFree || group.link.payload_bytes < payload_bytes) continue;
    if (!best.is_valid() || group.link.payload_bytes < at(best).link.payload_bytes) best = GroupId(i);
  }
  if (best.is_valid()) {
    at(best).state = State::kInUse;
    at(best).writer = writer;
    return best;
  }
  Message message;
  message << "no free group of " << payload_bytes << " bytes for " << name_of(writer, tasks);
  bool any = false;
  for (std::size_t i = 0; i < groups_.size(); ++i) {
    if (groups_[i].link.payload_bytes < payload_bytes) continue;
    explain(message, groups_[i], i, tasks);
    any = true;
  }
  if (!any) message << "; none of the " << groups_.size() << " groups is that large";
  return message.error(ErrorCode::kRefused);
}

void GroupPool::retire(GroupId id, std::uint64_t generation) noexcept {
  PooledGroup& group = at(id);
  CHIMERA_ASSERT(group.state == State::kInUse);
  CHIMERA_ASSERT(generation > 0);
  group.state = State::kRetired;
  group.retired_at = generation;
}

void GroupPool::writer_ended(GroupId id, WriterEnd how) noexcept {
  PooledGroup& group = at(id);
  CHIMERA_ASSERT(group.state != State::kFree);
  CHIMERA_ASSERT(how != WriterEnd::kNone);
  group.writer_end = how;
}

std::uint32_t GroupPool::reclaim(std::span<const Adoption> tasks) noexcept {
  std::uint32_t freed = 0;
  for (PooledGroup& group : groups_) {
    if (group.state != State::kRetired || group.writer_end == WriterEnd::kNone) continue;
    if (late_reader(tasks, group.retired_at) != nullptr) continue;
    const Link link = group.link;
    group = {};
    group.link = link;
    ++freed;
  }
  return freed;
}

const PooledGroup& GroupPool::group(GroupId id) const noexcept {
  CHIMERA_ASSERT(id.index < groups_.size());
  return groups_[id.index];
}

PooledGroup& GroupPool::at(GroupId id) noexcept {
  CHIMERA_ASSERT(id.index < groups_.size());
  return groups_[id.index];
}

}  // namespace chimera
