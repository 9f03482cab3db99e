// SPDX-License-Identifier: Apache-2.0
// Who is released when, and who runs next: the ready side of every single-context executor.
//
//   pause heap of classes (by next release)  --release_due-->  heap of runs (by urgency of the head)  --pop-->
//
// The classes of task_classes.h are released together, each by one entry of the pause heap. A pop takes the head of the
// most urgent run, so it is O(1) while one class is ready and O(log classes) otherwise; a thousand tasks of one rate
// cost a job no more than ten.
//
// Late rule: a release that comes while the previous one has not started replaces it (1 dropped); when k > 1
// releases went by at once the newest counts and k-1 are dropped. There is never a burst.
#pragma once

#include <cstdint>
#include <span>

#include "chimera/schedule/binary_heap.h"
#include "chimera/schedule/task_classes.h"

namespace chimera {

/// Releases that will never run: `count` of them up to and including `last`.
struct DroppedRelease {
  TaskId task;
  Nanoseconds last;
  std::uint32_t count = 0;
};

/// A job outside its run: preempted, or deferred until the task's previous job ended; part of QueueStorage.
struct LooseJob {
  Job job;
  Urgency urgency;
};

/// What a queue knows of a task beside its class; part of QueueStorage.
struct QueueTask {
  bool busy = false;         ///< a job of the task was taken and has not finished (preemptive use)
  bool has_pending = false;  ///< `pending` was released while busy
  bool is_loose = false;     ///< a job that never started waits among the loose ones
  Job pending;
};

/// Memory for a queue of n tasks: every span has n elements.
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
  /// All tasks start outside (OFF); TaskId = index in `tasks`. Requires: period > 0, every span of `storage` as
  /// long as `tasks`. Context: setup.
  ReadyQueue(Policy policy, std::span<const TaskSpec> tasks, const QueueStorage& storage) noexcept;
  /// The instant from which the grid counts, 0 until told. Requires: nobody has joined yet. Context: setup.
  void set_origin(Nanoseconds origin) noexcept;

  /// The task takes part from the first release of its grid at or after `now`. No effect when it already does.
  /// Context: cycle boundary; O(class + log classes).
  void join(TaskId task, Nanoseconds now) noexcept;
  /// The task takes part no more; a job of it that waits is forgotten without a count. No effect when outside.
  /// Context: cycle boundary; O(class + classes).
  void leave(TaskId task) noexcept;
  /// A job of the task waits that was released before that instant. Context: cycle boundary; O(class + waiting jobs).
  bool has_waiting(TaskId task, Nanoseconds before) const noexcept;
  /// The newest release of the members' grids that has come; before the origin when none has. Context: cycle boundary;
  /// O(classes).
  Nanoseconds latest_release() const noexcept;

  /// The next instant at which release_due has something to do; kNever without members. Context: cycle; O(1).
  Nanoseconds next_release() const noexcept {
    return pauses_.is_empty() ? kNever : classes_[pauses_.top()].next;
  }
  /// Releases every class whose time has come and calls `dropped(const DroppedRelease&)` for what is lost by it.
  /// Context: cycle; O(log classes) for each class released, O(1) for each release dropped.
  template <class Dropped>
  void release_due(Nanoseconds now, Dropped&& dropped) noexcept {
    while (next_release() <= now) release_class(pauses_.top(), now, dropped);
  }

  bool is_empty() const noexcept { return runs_.is_empty() && loose_.is_empty(); }
  /// The urgency of what pop would give. Requires: not empty. Context: cycle; O(1).
  Urgency top_urgency() const noexcept;
  /// Takes the most urgent job; ties: user priority, then order of the tasks. Requires: not empty.
  /// Context: cycle; O(1) while one class is ready, else O(log classes).
  Job pop() noexcept {
    const std::uint32_t others = (runs_.size() - 1) | n_beside_;  // one branch for both
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

  /// Preemptive use: the job of the task runs; releases until finish() wait for its end.
  void occupy(TaskId task) noexcept;
  /// The job of the task ended; a release that came meanwhile becomes ready. Context: cycle; O(log n).
  void finish(TaskId task) noexcept;
  /// Puts a preempted job back, with the execution time it still needs. Context: cycle; O(log n).
  void put_back(const Job& job, Nanoseconds remaining) noexcept;
  /// Takes the waiting (or preempted) job of the task out; false when none waits. `job` receives it.
  /// Context: cycle; O(class + waiting jobs).
  bool remove(TaskId task, Job& job) noexcept;

  /// Who is a member (is_active), from which release on (first_release), by which policy. Context: cycle boundary.
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
    if (n_deferred_ > 0) drop_deferred(c, dropped);
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
  BinaryHeap<std::uint32_t> runs_;    // of classes with members that are yet to be popped
  BinaryHeap<LooseJob> loose_;
  std::uint32_t n_beside_ = 0;    // tasks that are busy, and loose jobs
  std::uint32_t n_deferred_ = 0;  // tasks with has_pending or is_loose
};

}  // namespace chimera
