// SPDX-License-Identifier: Apache-2.0
// Why a task missed a deadline: by which task's execution time, or by something else than the tasks of this context.
// `waited` is the time since the first missed release that no verdict was about yet. `excess` of a task is the most
// that one of its jobs used, since the release before the missed one, beyond its budget (without one: its period). The
// cases in order of test; the same numbers stand at the returns of judge():
//   1. The last verdict about this task is less than 100 ms old: none is given.
//   2. No missed release is remembered, or an excess is more than half of `waited`: the task of greatest excess.
//   3. The job of the task itself is under way and waits in a system call: the task itself, blocked.
//   4. The task has no budget, and its job under way used more than half of `waited`: the task itself.
//   5. Some task has an excess: the task of greatest excess.
//   6. For 1 ms and more of `waited` no task of this context had the processor: none of them (real-time threads were
//      throttled, or the kernel or another process had it).
//   7. Else the task that came nearest to its budget.
#pragma once

#include <algorithm>
#include <atomic>
#include <cstdint>
#include <optional>
#include <span>

#include "chimera/base/setup_memory.h"
#include "chimera/runtime/job/job_threads.h"
#include "chimera/task/task.h"

namespace chimera {

/// Cycle boundaries judge, one verdict at a time. Jobs report their execution times from their own threads.
class MissCause {
 public:
  struct Verdict {
    TaskId culprit;    ///< the task that used the time; invalid: no task of this context
    Nanoseconds used;  ///< by the culprit; without one: for how long, at least, the processor was away
    bool is_blocked = false;  ///< the culprit is the task itself, which waits in a system call
  };

  /// All outlive this. Context: setup.
  MissCause(std::span<const Task> tasks, JobThreads& threads, SetupMemory& memory);

  /// A job of the task ended at `end` and had used `used`. Context: cycle, on the task's own thread; wait-free.
  void ended(TaskId task, Nanoseconds used, Nanoseconds end) noexcept { recent_[task.index].add(used, end); }
  /// The task missed the deadline of this release. Context: cycle, on the task's own thread, or
  /// cycle boundary; wait-free.
  void missed(TaskId task, Nanoseconds release) noexcept {
    std::atomic<std::int64_t>& waits = waits_[task.index].since;
    if (release.count < waits.load(std::memory_order_relaxed)) waits.store(release.count, std::memory_order_relaxed);
  }
  /// The cause of what the task missed since the last verdict, by the cases above.
  /// Context: cycle boundary; O(tasks).
  std::optional<Verdict> judge(TaskId task, Nanoseconds now) noexcept;
  /// A verdict on the task may be given at `now`. Context: cycle boundary; wait-free.
  bool may_judge(TaskId task, Nanoseconds now) const noexcept { return now - judged_[task.index] >= kSeldom; }

 private:
  static constexpr Nanoseconds kSeldom = milliseconds(100);

  // Execution times and ends of a task's last jobs: it may have had several since the release that was missed.
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
    // Relaxed, pair with nothing: written by the task's own thread, read by cycle boundaries. If a reader gets one
    // number of the old job and one of the new, it misjudges one miss.
    std::atomic<std::int64_t> used_[kJobs]{}, end_[kJobs]{};
    std::uint32_t next_ = 0;  // by the task's own thread
  };

  // The first release of the task that was missed since the last verdict; kNever: none.
  struct Waits {
    // Relaxed, pairs with nothing: lowered by the task's own thread and by cycle boundaries, cleared by judge(). If
    // both lower it at once, one of the two misses is forgotten.
    std::atomic<std::int64_t> since{kNever.count};
  };

  std::optional<Verdict> by_itself(TaskId missed, Nanoseconds since, Nanoseconds now) const noexcept;
  Nanoseconds taken_away(Nanoseconds since, Nanoseconds now) const noexcept;

  std::span<const Task> tasks_;
  JobThreads& threads_;
  // By task.
  std::span<Recent> recent_;
  std::span<Nanoseconds> judged_;  // when, last
  std::span<Waits> waits_;
};

}  // namespace chimera
