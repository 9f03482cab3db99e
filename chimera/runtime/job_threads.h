// SPDX-License-Identifier: Apache-2.0
// Who runs the jobs of a context: threads of their own, or the thread that takes the edges.
#pragma once

#include <span>

#include "chimera/base/ids.h"
#include "chimera/base/time.h"
#include "chimera/runtime/job_step.h"
#include "chimera/schedule/ready_queue.h"
#include "chimera/task/task.h"

namespace chimera {

/// What edges ask of whoever runs the jobs.
class JobThreads {
 public:
  /// Keeps the task's thread from beginning a job until the edge is over; a job that waits is put back. False while a
  /// job of it is under way: then an edge follows its end. Context: cycle boundary; wait-free.
  virtual bool claim(TaskId task) noexcept = 0;
  /// Execution time of the job of the task that is under way; 0 without one. Context: cycle boundary; wait-free.
  virtual Nanoseconds used_by_job(TaskId task) noexcept = 0;
  /// True when the job of the task that is under way was found waiting in a system call, before this edge.
  /// Context: cycle boundary; wait-free.
  virtual bool is_blocked(TaskId task) noexcept = 0;
  /// Calls a method of a task at an edge, as call_method(): where jobs preempt each other at the urgency of the task,
  /// and what the edge may touch may change meanwhile. Context: cycle boundary; as long as the method takes.
  virtual Answer call(Task& task, Method method, Nanoseconds now) noexcept { return call_method(task, method, now); }

  // Of a switch (switching.h). Context of all: cycle boundary; wait-free.

  /// call() delays no job that is more urgent than the task: no idle gap has to be waited for.
  virtual bool run_beside_methods() const noexcept = 0;
  /// Jobs preempt each other: a method needs no idle gap. In virtual time, where a method holds the processor all the
  /// same, it runs in a gap that comes soon.
  virtual bool preempt() const noexcept = 0;
  /// No job has taken a later release.
  virtual Nanoseconds latest_release() const noexcept = 0;
  /// A job that was released before `at` is under way, or waits.
  virtual bool has_job_before(TaskId task, Nanoseconds at) const noexcept = 0;
  /// An edge follows the end of the job that is under way, or of the next one; the task has no other job before it.
  virtual void await_job(TaskId task) noexcept = 0;
  /// Releases at `from` and later are not taken, of no task, until let_release() says so for the task.
  virtual void hold_releases(Nanoseconds from) noexcept = 0;
  /// The task is released as its state says, also by what was held. No effect on tasks of other contexts.
  virtual void let_release(TaskId task) noexcept = 0;
  /// When an edge that waits for jobs may find something new although nobody asks for one.
  virtual Nanoseconds next_look(Nanoseconds now) const noexcept = 0;

 protected:
  ~JobThreads() = default;
};

/// Jobs run in the thread that takes the edges: between two jobs none is under way, but for one that virtual time has
/// begun and not ended. That thread takes no release while it is at an edge.
class JobsInLoop : public JobThreads {
 public:
  /// Both outlive this; `queue` may be null where nothing is switched. Context: setup.
  /// `preemptive`: in virtual time jobs preempt each other.
  JobsInLoop(std::span<const Task> tasks, const ReadyQueue* queue, bool preemptive = false) noexcept
      : tasks_(tasks), queue_(queue), preemptive_(preemptive) {}

  bool claim(TaskId task) noexcept override { return !tasks_[task.index].is_busy; }
  Nanoseconds used_by_job(TaskId) noexcept override { return {}; }
  bool is_blocked(TaskId) noexcept override { return false; }
  bool run_beside_methods() const noexcept override { return false; }
  bool preempt() const noexcept override { return preemptive_; }
  Nanoseconds latest_release() const noexcept override { return queue_->latest_release(); }
  bool has_job_before(TaskId task, Nanoseconds at) const noexcept override {
    return tasks_[task.index].is_busy || queue_->has_waiting(task, at);
  }
  void await_job(TaskId) noexcept override {}
  void hold_releases(Nanoseconds) noexcept override {}
  void let_release(TaskId) noexcept override {}
  Nanoseconds next_look(Nanoseconds) const noexcept override { return queue_->next_release(); }

 private:
  std::span<const Task> tasks_;
  const ReadyQueue* queue_;
  bool preemptive_;
};

}  // namespace chimera
