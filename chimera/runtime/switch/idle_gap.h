// SPDX-License-Identifier: Apache-2.0
// Where a method other than a cycle may run beside the cycles of one processor without delaying any: while nothing is
// released, in a gap that is as long as the method is known to take. Where jobs preempt each other no gap is needed.
#pragma once

#include <algorithm>
#include <span>

#include "chimera/runtime/job_threads.h"
#include "chimera/schedule/ready_queue.h"
#include "chimera/task/task.h"

namespace chimera {

/// What is looked for before `on` of a task may run. Context: any; wait-free.
class NeededGaps {
 public:
  /// So long; 0: it runs beside the jobs of others.
  virtual Nanoseconds for_on(TaskId task) const noexcept = 0;

 protected:
  ~NeededGaps() = default;
};

/// Context: cycle boundary; wait-free.
class IdleGap {
 public:
  /// A method that was never called is taken to need the budget of its task; without one, so long.
  static constexpr Nanoseconds kUnknownMethod = microseconds(100);
  /// A gap is not waited for longer: of a method that was never called, or while the flag is up.
  static constexpr Nanoseconds kLongestWait = milliseconds(100);

  /// All given outlive this.
  IdleGap(std::span<const Task> tasks, const ReadyQueue& queue, const JobThreads& threads) noexcept
      : tasks_(tasks), queue_(queue), threads_(threads) {}

  /// No job is under way, and none that was released waits. O(tasks).
  bool is_there() const noexcept {
    if (threads_.run_beside_methods()) return true;
    return queue_.is_empty() && std::none_of(tasks_.begin(), tasks_.end(), [](const Task& t) { return t.is_busy; });
  }
  /// It is, and the next release is so far away as the method takes at most of late, and a fifth of that. O(tasks).
  bool is_for(const Task& task, Method method, Nanoseconds now) const noexcept {
    if (threads_.run_beside_methods()) return true;
    return is_there() && queue_.next_release() - now >= needed(*task.spec, task.profile, method);
  }
  /// A gap that comes at all comes within this time: one period of the slowest task that is ON, at most kLongestWait.
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
