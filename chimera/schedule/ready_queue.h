// SPDX-License-Identifier: Apache-2.0
// Decides when tasks are released and which job runs next: the ready queue of every single-context executor.
//
//   pause heap of classes (by next release)  --release_due-->  heap of runs (by urgency of the head)  --pop-->
//
// A class of task_classes.h is released as a whole, by one entry of the pause heap. A pop takes the head of the most
// urgent run. So it is O(1) while one class is ready, and O(log classes) otherwise. With a thousand tasks of one rate,
// a job costs no more than with ten.
//
// Late rule: a release replaces an earlier release of its task that has not started (1 dropped). If k > 1 releases
// passed at once, the newest counts and k-1 are dropped. A burst never occurs.
#pragma once

#include <cstdint>
#include <span>

#include "chimera/base/mechanisms.h"
#include "chimera/schedule/binary_heap.h"
#include "chimera/schedule/task_classes.h"

namespace chimera {

/// Releases without a job: `count` of them, up to and including `last`.
struct DroppedRelease {
  TaskId task;
  Nanoseconds last;
  std::uint32_t count = 0;
};

/// A job outside its run: preempted, or deferred until the previous job of its task ends; part of QueueStorage.
struct LooseJob {
  Job job;
  Urgency urgency;
};

/// The data of a task beside its class; part of QueueStorage.
struct QueueTask {
  bool busy = false;         ///< a job of the task was popped and has not finished (preemptive use)
  bool has_pending = false;  ///< `pending` was released while busy
  bool is_loose = false;     ///< a loose job of the task waits and never started
  Job pending;
};

/// Memory for a queue of n tasks: every span has n elements, but `runs` and `pauses` one for each class. `tasks` is for
/// preemptive use, `loose` also for jobs that events release.
struct QueueStorage {
  TaskClasses::Storage classes;
  std::span<QueueTask> tasks;
  std::span<LooseJob> loose;
  std::span<std::uint32_t> pauses;
  std::span<std::uint32_t> runs;
};

/// Pure logic over given memory: no clock, no heap, no OS.
class ReadyQueue {
 public:
  /// All tasks start inactive (OFF); TaskId = index in `tasks`. Requires: period > 0, every span of `storage` as long
  /// as `tasks`, which outlives this. Context: setup.
  ReadyQueue(Policy policy, std::span<const TaskSpec> tasks, const QueueStorage& storage) noexcept;
  /// Sets the origin of the grid; 0 by default. Requires: no task has joined yet. Context: setup.
  void set_origin(Nanoseconds origin) noexcept;

  /// Activates the task from the first release of its grid at or after `now`. No effect if it is active. Context: cycle
  /// boundary; O(class + log classes).
  void join(TaskId task, Nanoseconds now) noexcept;
  /// Deactivates the task and discards a waiting job of it without a count. No effect if it is inactive. Context: cycle
  /// boundary; O(class + classes).
  void leave(TaskId task) noexcept;
  /// True if a job of the task waits that was released before `before`. Context: cycle boundary; O(class + waiting
  /// jobs).
  bool has_waiting(TaskId task, Nanoseconds before) const noexcept;
  /// The newest past release on the grids of active tasks; an instant before the origin if none has come. Context:
  /// cycle boundary; O(classes).
  Nanoseconds latest_release() const noexcept;

  /// The next instant at which release_due() has work; kNever without active tasks. Context: cycle; O(1).
  Nanoseconds next_release() const noexcept {
    return pauses_.is_empty() ? kNever : classes_[pauses_.top()].next;
  }
  /// Releases each class whose time has come, and calls `dropped(const DroppedRelease&)` for lost releases. Context:
  /// cycle; O(log classes) for each class released, O(1) for each release dropped.
  template <class Dropped>
  void release_due(Nanoseconds now, Dropped&& dropped) noexcept {
    while (next_release() <= now) release_class(pauses_.top(), now, dropped);
  }

  bool is_empty() const noexcept { return runs_.is_empty() && (!mechanisms::kLooseJobs || loose_.is_empty()); }
  /// The urgency of the job that pop() would return. Requires: not empty. Context: cycle; O(1).
  Urgency top_urgency() const noexcept;
  /// Removes and returns the most urgent job; ties: user priority, then tie_of(). Requires: not empty.
  /// Context: cycle; O(1) while one class is ready, otherwise O(log classes).
  Job pop() noexcept {
    const std::uint32_t others = (runs_.size() - 1) | (mechanisms::kLooseJobs ? n_beside_ : 0);  // one branch
    if (others != 0) [[unlikely]] return pop_among();
    TaskClass& c = classes_[runs_.top()];
    const ClassMember& m = classes_.member(c, c.cursor);
    do {
      if (++c.cursor == c.active) {
        runs_.clear();
        break;
      }
    } while (classes_.member(c, c.cursor).first > c.release);
    return TaskClasses::job(c, m);
  }

  /// Preemptive use: a job of the task runs, and its releases wait until finish().
  void occupy(TaskId task) noexcept;
  /// The job of the task ended; a release that came during the job becomes ready. Context: cycle; O(log n).
  void finish(TaskId task) noexcept;
  /// Puts a preempted job back, with the execution time it still needs. Context: cycle; O(log n).
  void put_back(const Job& job, Nanoseconds remaining) noexcept;
  /// Removes the waiting or preempted job of the task and stores it in `job`; false if none waits. Context: cycle;
  /// O(class + waiting jobs).
  bool remove(TaskId task, Job& job) noexcept;

  /// The classes: active tasks (is_active), their first releases (first_release), and the policy. Context: cycle
  /// boundary.
  const TaskClasses& classes() const noexcept { return classes_; }

 private:
  // The orders of the three heaps.
  struct ByRelease {
    const TaskClasses& classes;
    bool operator()(std::uint32_t a, std::uint32_t b) const noexcept { return classes[a].next < classes[b].next; }
  };
  struct ByUrgency {
    const TaskClasses& classes;
    bool operator()(std::uint32_t a, std::uint32_t b) const noexcept { return classes.run_goes_before(a, b); }
    bool operator()(const LooseJob& a, const LooseJob& b) const noexcept {
      return classes.goes_before(a.urgency, a.job.task.index, b.urgency, b.job.task.index);
    }
  };

  template <class Dropped>
  void release_class(std::uint32_t index, Nanoseconds now, Dropped&& dropped) noexcept {
    TaskClass& c = classes_[index];
    const bool had_run = c.cursor < c.active;
    for (std::uint32_t i = c.cursor; i < c.active; ++i) {
      const ClassMember& m = classes_.member(c, i);
      if (m.first <= c.release) dropped(DroppedRelease{TaskId(m.task), c.release, 1});
    }
    if (mechanisms::kPreemptive && n_deferred_ > 0) drop_deferred(c, dropped);
    const std::int64_t passed = now < c.next + c.period ? 1 : (now - c.next) / c.period + 1;
    c.release = c.next + c.period * (passed - 1);
    c.next = c.release + c.period;
    for (std::uint32_t i = 0; passed > 1 && i < c.active; ++i) {
      const ClassMember& m = classes_.member(c, i);
      const Nanoseconds last = c.release - c.period;
      if (m.first <= last) dropped(DroppedRelease{TaskId(m.task), last, static_cast<std::uint32_t>(passed - 1)});
    }
    c.cursor = 0;
    if (pauses_.size() > 1) pauses_.sift_top(ByRelease{classes_});
    if (had_run) remove_run(index);
    if (!settle(c)) return;
    if (runs_.is_empty()) return runs_.set_only(index);
    runs_.push(index, ByUrgency{classes_});
  }
  template <class Dropped>
  void drop_deferred(const TaskClass& c, Dropped&& dropped) noexcept {
    Job job;
    for (std::uint32_t i = 0; i < c.active; ++i) {
      const TaskId task(classes_.member(c, i).task);
      if (take_deferred(task, job)) dropped(DroppedRelease{task, job.release, 1});
    }
  }

  Job pop_among() noexcept;
  Job pop_loose() noexcept;
  bool loose_is_top() const noexcept;
  void push_loose(const Job& job, const Nanoseconds* remaining) noexcept;
  bool take_deferred(TaskId task, Job& job) noexcept;
  bool take_loose(TaskId task, Job& job) noexcept;
  bool take_from_run(TaskId task, Job& job) noexcept;
  bool settle(TaskClass& c) noexcept;
  void remove_run(std::uint32_t index) noexcept;
  void refresh_run(std::uint32_t index, bool had_run) noexcept;

  TaskClasses classes_;
  std::span<QueueTask> tasks_;
  BinaryHeap<std::uint32_t> pauses_;  // of active classes
  BinaryHeap<std::uint32_t> runs_;    // of classes with members left to pop
  BinaryHeap<LooseJob> loose_;
  std::uint32_t n_beside_ = 0;    // tasks that are busy, and loose jobs
  std::uint32_t n_deferred_ = 0;  // tasks with has_pending or is_loose
};

}  // namespace chimera
