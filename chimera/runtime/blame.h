// SPDX-License-Identifier: Apache-2.0
// Who is to blame for a missed deadline, by the execution time that jobs of a context used: the task that went furthest
// beyond its budget (one without: its period) since the release before the one that was missed. Before one who took
// less than half of the time since then comes the task itself, when its job waits in a system call, or has no budget
// and used more than all others. If none went beyond and the processor was away for 1 ms and more, it is nobody:
// real-time threads were throttled, or the kernel or another process had it. Else it is whoever came nearest.
#pragma once

#include <algorithm>
#include <atomic>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "chimera/runtime/job_threads.h"
#include "chimera/task/task.h"

namespace chimera {

class Blame {
 public:
  struct Verdict {
    TaskId culprit;    ///< invalid: nobody of this context
    Nanoseconds used;  ///< by it; by nobody: for so long, at least, the processor was away
    bool is_blocked = false;  ///< the culprit is the task itself, which waits in a system call
  };

  /// `threads` null: jobs run where the edges do. Both outlive this. Context: setup.
  Blame(std::span<const Task> tasks, JobThreads* threads);

  /// A job of the task ended at `end` and had used `used`. Context: cycle, on the task's own thread; wait-free.
  void ended(TaskId task, Nanoseconds used, Nanoseconds end) noexcept { recent_[task.index].add(used, end); }
  /// The task missed the deadline of this release. Context: cycle, on the task's own thread, or edge; wait-free.
  void missed(TaskId task, Nanoseconds release) noexcept {
    std::atomic<std::int64_t>& waits = waits_[task.index].since;  // two at once: one of them is forgotten
    if (release.count < waits.load(std::memory_order_relaxed)) waits.store(release.count, std::memory_order_relaxed);
  }
  /// Who is to blame for what the task missed since the last verdict; nothing when that was less than 100 ms ago.
  /// Asks JobThreads::is_blocked, with what that means for the caller. Context: edge; O(tasks).
  std::optional<Verdict> judge(TaskId task, Nanoseconds now) noexcept;

 private:
  // What the last jobs of a task used and when they ended: it may have had several since the release that was missed.
  class Recent {
   public:
    void add(Nanoseconds used, Nanoseconds end) noexcept {
      used_[next_].store(used.count, std::memory_order_relaxed);
      end_[next_].store(end.count, std::memory_order_relaxed);
      next_ = (next_ + 1) % kJobs;
    }
    Nanoseconds most_since(Nanoseconds since) const noexcept;
    /// By all that ended since then; kNever: they may be more than are remembered.
    Nanoseconds sum_since(Nanoseconds since) const noexcept;

   private:
    static constexpr std::uint32_t kJobs = 8;
    std::atomic<std::int64_t> used_[kJobs]{}, end_[kJobs]{};  // read by edges: a torn pair misjudges one miss
    std::uint32_t next_ = 0;                                  // by the task's own thread
  };

  // The first release that was missed since the last verdict; kNever: none.
  struct Waits {
    std::atomic<std::int64_t> since{kNever.count};
  };

  Nanoseconds used_by_job(TaskId task) const noexcept {
    return threads_ == nullptr ? Nanoseconds{} : threads_->used_by_job(task);
  }
  std::optional<Verdict> by_itself(TaskId missed, Nanoseconds since, Nanoseconds now) const noexcept;
  Nanoseconds taken_away(Nanoseconds since, Nanoseconds now) const noexcept;

  std::span<const Task> tasks_;
  JobThreads* threads_;
  // By task.
  std::vector<Recent> recent_;
  std::vector<Nanoseconds> judged_;  // when, last
  std::vector<Waits> waits_;
};

}  // namespace chimera
