// SPDX-License-Identifier: Apache-2.0
// The records that one context writes to its tap: events of its tasks, and every publication of tapped tasks.
#pragma once

#include <cstdint>
#include <span>

#include "chimera/base/fixed.h"
#include "chimera/base/mechanisms.h"
#include "chimera/base/setup_memory.h"
#include "chimera/runtime/record/digest.h"
#include "chimera/runtime/record/tap_ring.h"
#include "chimera/schedule/ready_queue.h"
#include "chimera/task/task.h"

namespace chimera {

/// Context of everything not marked: cycle; wait-free, by the thread that may append to the tap.
class ContextTap {
 public:
  /// `tap` null: nothing is recorded. With `keeps`, records of a task with a job under way stay with the thread of the
  /// task until flush(). With `digest` it gets the faults, and the publications in place of the tap. The tasks, the tap
  /// and the digest outlive this. Context: setup.
  ContextTap(std::span<const Task> tasks, Tap* tap, std::uint8_t rtpu, bool keeps, SetupMemory& memory,
             Digest* digest = nullptr);

  bool is_on() const noexcept { return mechanisms::kTap && tap_ != nullptr; }
  /// Writes one record if there is a tap. An invalid task: of the context. Where records are kept, the thread of a task
  /// may call this for its task.
  void record(TapKind kind, Nanoseconds at, TaskId task, std::uint64_t a, std::int64_t b = 0) noexcept {
    if (is_on()) append(kind, at, task, a, b);
  }
  /// Writes one record at once, before those that are kept for the task's thread.
  void record_now(TapKind kind, Nanoseconds at, TaskId task, std::uint64_t a, std::int64_t b = 0) noexcept;
  /// The last fault of the task, which is new.
  void record_fault(const Task& task) noexcept {
    record(TapKind::kFault, task.faults.at, task.id, static_cast<std::uint64_t>(task.faults.method));
    if (mechanisms::kDigest && digest_ != nullptr) digest_->add_faults(task);
  }
  /// Leaves what `on` of an armed task published out of the digest: its instant depends on the machine.
  void pass_over(TaskId task) noexcept {
    if (mechanisms::kDigest && digest_ != nullptr) rows_[task.index].last = tasks_[task.index].group.sequence();
  }
  /// The release of a job, when the job is about to begin or will not run.
  void record_release(const Job& job) noexcept {
    const std::int64_t left = job.deadline == kNever ? 0 : (job.deadline - job.release).count;
    record(TapKind::kRelease, job.release, job.task, tasks_[job.task.index].call.cycle, left);
  }
  /// Hands over what the task's thread kept, and its latest publication if it is tapped.
  void flush(TaskId id) noexcept;
  /// A job of the task has published: its row, now, or with flush() where records are kept.
  void job_published(const Task& task) noexcept {
    if (kept_.empty()) append_row(task);
  }
  /// The latest publication of the task, once.
  void append_row(const Task& task) noexcept;

 private:
  /// Room for more records than one job makes.
  using Kept = FixedVector<TapRecord, 16>;
  struct Rows {
    std::uint64_t last = 0;   // sequence of the publication
    std::uint32_t count = 0;
  };

  void append(TapKind kind, Nanoseconds at, TaskId task, std::uint64_t a, std::int64_t b) noexcept;
  TapRecord record_of(TapKind kind, Nanoseconds at, TaskId task, std::uint64_t a, std::int64_t b) const noexcept;

  std::span<const Task> tasks_;
  Tap* tap_;
  Digest* digest_;
  std::uint8_t rtpu_;
  // By task.
  std::span<Rows> rows_;
  std::span<Kept> kept_;  // empty: none are
};

}  // namespace chimera
