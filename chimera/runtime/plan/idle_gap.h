// SPDX-License-Identifier: Apache-2.0
// Finds gaps in which a method other than a cycle can run without delaying the cycles of the processor. A gap is long
// enough if no release falls into the known duration of the method. Where jobs preempt each other no gap is needed.
#pragma once

#include <algorithm>
#include <span>

#include "chimera/runtime/job/job_threads.h"
#include "chimera/schedule/ready_queue.h"
#include "chimera/task/task.h"

namespace chimera {

/// Gap that must be free before `on` of a task may run. Context: any; wait-free.
class NeededGaps {
 public:
  /// Idle time that `on` of the task needs; 0: none, because it runs beside the jobs of others.
  virtual Nanoseconds for_on(TaskId task) const noexcept = 0;

 protected:
  ~NeededGaps() = default;
};

/// Context: cycle boundary; wait-free.
class IdleGap {
 public:
  /// Assumed duration of a method that was never called, if its task has no budget.
  static constexpr Nanoseconds kUnknownMethod = microseconds(100);
  /// Longest wait for a gap: for `off`, or while the flag is up.
  static constexpr Nanoseconds kLongestWait = milliseconds(100);

  /// All arguments outlive this.
  IdleGap(std::span<const Task> tasks, const ReadyQueue& queue, const JobThreads& threads) noexcept
      : tasks_(tasks), queue_(queue), threads_(threads) {}

  /// No job is under way, and no released job waits. O(tasks).
  bool is_there() const noexcept {
    if (threads_.run_beside_methods()) return true;
    return queue_.is_empty() && std::none_of(tasks_.begin(), tasks_.end(), [](const Task& t) { return t.is_busy; });
  }
  /// A gap is there and lasts until the next release for the longest recent time of the method plus one fifth.
  /// O(tasks).
  bool is_for(const Task& task, Method method, Nanoseconds now) const noexcept {
    if (threads_.run_beside_methods()) return true;
    return is_there() && queue_.next_release() - now >= needed(*task.spec, task.profile, method);
  }
  /// If a gap comes at all, it comes within this time: one period of the slowest task that is ON, at most kLongestWait.
  /// O(tasks).
  Nanoseconds soon() const noexcept {
    Nanoseconds longest = milliseconds(1);
    for (const Task& task : tasks_)
      if (task.state == State::kOn && !task.spec->aperiodic) longest = std::max(longest, task.spec->period);
    return std::min(longest, kLongestWait);
  }
  static Nanoseconds needed(const TaskSpec& task, const Profile& profile, Method method) noexcept {
    const Nanoseconds guess = task.budget > Nanoseconds{} ? task.budget : kUnknownMethod;
    if (profile.execution[static_cast<int>(method)].count == 0) return guess;
    const Nanoseconds longest = profile.of_late(method);
    return longest + Nanoseconds{longest.count / 5};
  }

 private:
  std::span<const Task> tasks_;
  const ReadyQueue& queue_;
  const JobThreads& threads_;
};

}  // namespace chimera
