// SPDX-License-Identifier: Apache-2.0
// Fills in the records of a context's tap and appends them.
#include "chimera/runtime/record/context_tap.h"

namespace chimera {

ContextTap::ContextTap(std::span<const Task> tasks, Tap* tap, std::uint8_t rtpu, bool keeps,
                       SetupMemory& memory, Digest* digest)
    : tasks_(tasks), tap_(tap), digest_(digest), rtpu_(rtpu), rows_(memory.take<Rows>(tasks.size())),
      kept_(memory.take<Kept>(keeps ? tasks.size() : 0)) {}

void ContextTap::append(TapKind kind, Nanoseconds at, TaskId task, std::uint64_t a, std::int64_t b) noexcept {
  const TapRecord r = record_of(kind, at, task, a, b);
  if (kept_.empty() || !task.is_valid() || !tasks_[task.index].is_busy) return tap_->append(r);
  (void)kept_[task.index].try_push(r);
}

void ContextTap::record_now(TapKind kind, Nanoseconds at, TaskId task, std::uint64_t a, std::int64_t b) noexcept {
  if (is_on()) tap_->append(record_of(kind, at, task, a, b));
}

TapRecord ContextTap::record_of(TapKind kind, Nanoseconds at, TaskId task, std::uint64_t a,
                                std::int64_t b) const noexcept {
  TapRecord r;
  r.at = at;
  r.b = b;
  r.a = static_cast<std::uint32_t>(a);
  r.task = task;
  r.kind = kind;
  r.rtpu = rtpu_;
  return r;
}

void ContextTap::flush(TaskId id) noexcept {
  if (!is_on() && digest_ == nullptr) return;
  for (const TapRecord& record : kept_[id.index]) tap_->append(record);
  kept_[id.index].clear();
  if (tasks_[id.index].is_tapped) append_row(tasks_[id.index]);
}

void ContextTap::append_row(const Task& task) noexcept {
  Rows& rows = rows_[task.id.index];
  if (task.standing == Standing::kWarm) return;  // its publications are no values of variables
  if (task.group.sequence() == rows.last || task.group.sequence() == 0) return;
  rows.last = task.group.sequence();
  // With a digest no other reader wants rows.
  if (mechanisms::kDigest && digest_ != nullptr) return digest_->add_publication(task);
  if (!is_on()) return;
  tap_->append_row(*task.group.published(), task.group.payload_bytes(), task.id, rtpu_, rows.count++);
}

}  // namespace chimera
