// SPDX-License-Identifier: Apache-2.0
// Who is released when, and who runs next: the ready side of every single-context executor.
//
//   pause heap of classes (by next release)  --release_due-->  heap of runs (by urgency of the head)  --pop-->
//
// A *class* is all tasks with one (period, offset): they are released together by one entry of the pause heap.
// A release starts a *run*: the members of the class in urgency order, which is static within a class, for all
// were released at the same instant. A pop takes the head of the most urgent run, so it is O(1) while one class
// is ready and O(log classes) otherwise; a thousand tasks of one rate cost a job no more than ten.
//
// Releases lie on a grid: origin + offset + k * period, also for a task that goes ON later: its first release is
// the first one of the grid at or after that instant, so phases between tasks are kept over any off and on.
//
// Late rule: a release that comes while the previous one has not started replaces it (1 dropped); when k > 1
// releases went by at once the newest counts and k-1 are dropped. There is never a burst.
#pragma once

#include <cstdint>
#include <span>

#include "chimera/base/ids.h"
#include "chimera/base/time.h"
#include "chimera/schedule/policy.h"
#include "chimera/task/task_spec.h"

namespace chimera {

/// One released cycle of one task.
struct Job {
  TaskId task;
  Nanoseconds release;
  Nanoseconds deadline;  ///< absolute
};

/// Releases that will never run: `count` of them up to and including `last`.
struct DroppedRelease {
  TaskId task;
  Nanoseconds last;
  std::uint32_t count = 0;
};

/// One member of a class; part of QueueStorage.
struct QueueMember {
  Nanoseconds deadline;   ///< relative
  Nanoseconds budget;
  Nanoseconds first;      ///< no release before this instant: the task was not ON yet
  std::uint32_t task = 0;
  std::uint32_t criticality = 0;
  std::uint32_t user_priority = 0;
};

/// All tasks of one (period, offset); part of QueueStorage.
struct QueueClass {
  Nanoseconds period, offset;
  Nanoseconds next;            ///< the coming release
  Nanoseconds release;         ///< of the present run
  std::uint32_t begin = 0;     ///< first member; active ones come first, in urgency order
  std::uint32_t active = 0;
  std::uint32_t size = 0;
  std::uint32_t cursor = 0;    ///< members of the present run already taken; == active: no run
};

/// A job outside its run: preempted, or deferred until the task's previous job ended; part of QueueStorage.
struct LooseJob {
  Job job;
  Urgency urgency;
};

/// What a queue knows of a task beside its class; part of QueueStorage.
struct QueueTask {
  std::uint32_t of_class = 0;
  bool busy = false;         ///< a job of the task was taken and has not finished (preemptive use)
  bool has_pending = false;  ///< `pending` was released while busy
  bool is_loose = false;     ///< a job that never started waits among the loose ones
  Job pending;
};

/// Memory for a queue of n tasks: every span has n elements.
struct QueueStorage {
  std::span<QueueMember> members;
  std::span<QueueClass> classes;
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
  /// The first release that the member takes part in. Context: cycle boundary.
  Nanoseconds first_release(TaskId task) const noexcept { return storage_.members[find(task.index)].first; }
  /// True between join and leave. Context: cycle boundary.
  bool is_member(TaskId task) const noexcept;

  /// The next instant at which release_due has something to do; kNever without members. Context: cycle; O(1).
  Nanoseconds next_release() const noexcept {
    return n_pauses_ == 0 ? kNever : storage_.classes[storage_.pauses[0]].next;
  }
  /// Releases every class whose time has come and calls `dropped(const DroppedRelease&)` for what is lost by it.
  /// Context: cycle; O(log classes) for each class released, O(1) for each release dropped.
  template <class Dropped>
  void release_due(Nanoseconds now, Dropped&& dropped) noexcept {
    while (next_release() <= now) release_class(storage_.pauses[0], now, dropped);
  }

  bool is_empty() const noexcept { return n_runs_ == 0 && n_loose_ == 0; }
  /// The urgency of what pop would give. Requires: not empty. Context: cycle; O(1).
  Urgency top_urgency() const noexcept;
  /// Takes the most urgent job; ties: user priority, then order of the tasks. Requires: not empty.
  /// Context: cycle; O(1) while one class is ready, else O(log classes).
  Job pop() noexcept {
    if (n_runs_ != 1 || n_loose_ != 0 || n_busy_ != 0) [[unlikely]] return pop_among();
    QueueClass& c = storage_.classes[storage_.runs[0]];
    const QueueMember& m = storage_.members[c.begin + c.cursor];
    do {
      if (++c.cursor == c.active) {
        n_runs_ = 0;
        break;
      }
    } while (storage_.members[c.begin + c.cursor].first > c.release);
    return {TaskId(m.task), c.release, c.release + m.deadline};
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

  Policy policy() const noexcept { return policy_; }

 private:
  template <class Dropped>
  void release_class(std::uint32_t index, Nanoseconds now, Dropped&& dropped) noexcept {
    QueueClass& c = storage_.classes[index];
    const bool had_run = c.cursor < c.active;
    for (std::uint32_t i = c.cursor; i < c.active; ++i) {
      const QueueMember& m = storage_.members[c.begin + i];
      if (m.first <= c.release) dropped(DroppedRelease{TaskId(m.task), c.release, 1});
    }
    if (n_deferred_ > 0) drop_deferred(index, dropped);
    const std::int64_t passed = now < c.next + c.period ? 1 : (now - c.next) / c.period + 1;
    c.release = c.next + c.period * (passed - 1);
    c.next = c.release + c.period;
    for (std::uint32_t i = 0; passed > 1 && i < c.active; ++i) {
      const QueueMember& m = storage_.members[c.begin + i];
      const Nanoseconds last = c.release - c.period;
      if (m.first <= last) dropped(DroppedRelease{TaskId(m.task), last, static_cast<std::uint32_t>(passed - 1)});
    }
    c.cursor = 0;
    if (n_pauses_ > 1) sift_pause_down(0);
    if (had_run) remove_run(index);
    if (!settle(c)) return;
    if (n_runs_ > 0) return push_run(index);
    storage_.runs[0] = index;
    n_runs_ = 1;
  }
  template <class Dropped>
  void drop_deferred(std::uint32_t index, Dropped&& dropped) noexcept {
    const QueueClass& c = storage_.classes[index];
    Job job;
    for (std::uint32_t i = 0; i < c.active; ++i) {
      const TaskId task(storage_.members[c.begin + i].task);
      if (take_deferred(task, job)) dropped(DroppedRelease{task, job.release, 1});
    }
  }

  void make_classes(std::span<const TaskSpec> tasks) noexcept;
  std::uint32_t find(std::uint32_t task) const noexcept;
  bool goes_before(const Urgency& a, std::uint32_t a_task, const Urgency& b, std::uint32_t b_task) const noexcept;
  static Urgency urgency_of(const QueueClass& c, const QueueMember& m) noexcept;
  Nanoseconds grid_at_or_after(const QueueClass& c, Nanoseconds now) const noexcept;
  bool take_deferred(TaskId task, Job& job) noexcept;
  bool take_from_run(TaskId task, Job& job) noexcept;
  void refresh_run(std::uint32_t index, bool had_run) noexcept;
  Job pop_among() noexcept;
  Job pop_loose() noexcept;
  bool settle(QueueClass& c) noexcept;
  const QueueMember& head(std::uint32_t index) const noexcept;
  Urgency run_urgency(std::uint32_t index) const noexcept;
  bool run_before(std::uint32_t a, std::uint32_t b) const noexcept;
  bool loose_before(const LooseJob& a, const LooseJob& b) const noexcept;
  bool loose_is_top() const noexcept;
  LooseJob make_loose(const Job& job, const Nanoseconds* remaining) const noexcept;
  void push_run(std::uint32_t index) noexcept;
  void sift_run_down(std::uint32_t at) noexcept;
  void remove_run(std::uint32_t index) noexcept;
  void push_pause(std::uint32_t index) noexcept;
  void sift_pause_down(std::uint32_t at) noexcept;
  void remove_pause(std::uint32_t index) noexcept;
  void push_loose(const LooseJob& loose) noexcept;
  void remove_loose(std::uint32_t at) noexcept;

  Policy policy_;
  QueueStorage storage_;
  Nanoseconds origin_;
  std::uint32_t n_classes_ = 0;
  std::uint32_t n_pauses_ = 0;
  std::uint32_t n_runs_ = 0;
  std::uint32_t n_loose_ = 0;
  std::uint32_t n_busy_ = 0;
  std::uint32_t n_deferred_ = 0;  ///< tasks with has_pending or is_loose
};

}  // namespace chimera
